import { create } from "@bufbuild/protobuf";
import { Code, ConnectError } from "@connectrpc/connect";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { ArraySliceSchema, ArrayType, FrameSliceSchema } from "@wire/frame_service_pb";
import { ModelSchema } from "@wire/model_pb";
import { Simulation_State, SimulationSchema } from "@wire/simulation_pb";
import {
  FindShapeResponseSchema,
  FoundShapeSchema,
  type FindShapeRequest,
  type FindShapeResponse,
} from "@wire/simulation_service_pb";

// The page's address and storage, which the client asks for when it is loaded.
vi.hoisted(() => {
  Object.assign(globalThis, {
    location: { origin: "http://here", hash: "" },
    sessionStorage: { getItem: () => null, setItem: () => undefined },
  });
});

const { Latest } = await import("../../src/api/latest");
const { simulations } = await import("../../src/api/client");
const { collectShape } = await import("../../src/api/find_shape");
const { newInjection } = await import("../../src/plan/new_plan");
const { editPlan, plan, setModel } = await import("../../src/plan/state");
const added = await import("../../src/shape/added_fat");
const { bindShape, dragVolume, mostOf, releaseVolume } = await import("../../src/shape/plan_volumes");
const shape = await import("../../src/shape/state");
const run = await import("../../src/run/state");
const { step } = await import("../../src/stage/stage_state");

const rest = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

/** Questions that are under way, to be answered by the test. */
class Asked {
  readonly questions: number[] = [];
  private ends: { resolve: (answer: string) => void; reject: (error: unknown) => void }[] = [];
  ask = (question: number): Promise<string> => {
    this.questions.push(question);
    return new Promise((resolve, reject) => this.ends.push({ resolve, reject }));
  };
  async answer(text: string): Promise<void> {
    this.ends.shift()!.resolve(text);
    await rest();
  }
  async fail(error: unknown): Promise<void> {
    this.ends.shift()!.reject(error);
    await rest();
  }
}

describe("the newest question", () => {
  let asked: Asked;
  let told: string[];
  let latest: InstanceType<typeof Latest<number, string>>;
  beforeEach(() => {
    [asked, told] = [new Asked(), []];
    latest = new Latest<number, string>(asked.ask, {
      answered: (answer, question) => told.push(`${question}: ${answer}`),
      failed: (error) => told.push(ConnectError.from(error).rawMessage),
    });
  });
  it("is the only one that waits", async () => {
    for (const question of [1, 2, 3, 4]) latest.want(question);
    expect(asked.questions).toEqual([1]);
    await asked.answer("a");
    expect(asked.questions).toEqual([1, 4]);
    await asked.answer("d");
    expect(told).toEqual(["1: a", "4: d"]);
    latest.want(5);
    expect(asked.questions).toEqual([1, 4, 5]);
  });
  it("goes on after one that was superseded, which nobody hears of", async () => {
    latest.want(1);
    latest.want(2);
    await asked.fail(new ConnectError("a newer one came", Code.Aborted));
    await asked.answer("b");
    expect(told).toEqual(["2: b"]);
  });
  it("tells what is wrong once, until something was right again", async () => {
    const away = new ConnectError("away", Code.Unavailable);
    for (const question of [1, 2]) {
      latest.want(question);
      await asked.fail(away);
    }
    latest.want(3);
    await asked.answer("c");
    latest.want(4);
    await asked.fail(away);
    expect(told).toEqual(["away", "3: c", "away"]);
  });
  it("is not told of when it was left", async () => {
    latest.want(1);
    latest.want(2);
    latest.forget();
    latest.want(3);
    await asked.answer("a");
    expect(asked.questions).toEqual([1, 3]);
    await asked.answer("c");
    expect(told).toEqual(["3: c"]);
  });
});

const found = (fields: object): FindShapeResponse =>
  create(FindShapeResponseSchema, {
    message: { case: "shape", value: create(FoundShapeSchema, { volumeShare: 1, ...fields }) },
  });
function slice(values: number[], part: number[], offset: number): FindShapeResponse {
  const field = create(ArraySliceSchema, {
    name: "scan.pressure",
    type: ArrayType.FLOAT32,
    shape: [BigInt(values.length)],
    offsetBytes: BigInt(offset),
    data: new Uint8Array(Float32Array.from(part).buffer),
  });
  return create(FindShapeResponseSchema, {
    message: { case: "frame", value: create(FrameSliceSchema, { timeS: 2, fields: [field] }) },
  });
}
async function* streamOf(...responses: FindShapeResponse[]): AsyncGenerator<FindShapeResponse> {
  for (const response of responses) yield response;
}

describe("the answer", () => {
  it("is put together from its pieces", async () => {
    const all = [1, 2, 3];
    const { found: figures, frame } = await collectShape(
      streamOf(found({ reason: "r" }), slice(all, [1, 2], 0), slice(all, [3], 8)),
    );
    expect(figures.reason).toBe("r");
    expect(frame.timeS).toBe(2);
    expect([...new Float32Array(frame.fields.get("scan.pressure")!.bytes.buffer as ArrayBuffer)]).toEqual(all);
  });
  it("without figures is none", async () => {
    await expect(collectShape(streamOf(slice([1], [1], 0)))).rejects.toThrow(/figures/);
  });
});

const volume = (index: number, volumeMl: number) => ({ index, volumeMl });

describe("a slider of the plan", () => {
  const requests: FindShapeRequest[] = [];
  let answer: () => AsyncIterable<FindShapeResponse>;
  let unbind: () => void;
  beforeEach(() => {
    requests.length = 0;
    answer = () => streamOf(found({ summary: { injectedMl: 2 } }), slice([1], [1], 0));
    vi.spyOn(simulations, "findShape").mockImplementation((request) => {
      requests.push(request as FindShapeRequest);
      return answer();
    });
    [step.value, run.simulation.value] = ["fat", undefined];
    editPlan(({ simulation }) => (simulation!.injections = [newInjection("masseter"), newInjection("malar")]));
    setModel(create(ModelSchema, { name: "patients/a/models/b" }), undefined);
    unbind = bindShape();
  });
  afterEach(() => {
    unbind();
    shape.clear();
    vi.restoreAllMocks();
  });

  it("asks while it is dragged, by one name, and changes the plan when it is let go", async () => {
    dragVolume(1, 1.5);
    await rest();
    dragVolume(1, 2);
    await rest();
    expect(requests.map(({ injections }) => injections)).toEqual([
      [volume(0, 1), volume(1, 1.5)],
      [volume(0, 1), volume(1, 2)],
    ]);
    expect(requests[0].drag).toMatch(/^[a-z][a-z0-9-]{0,62}$/);
    expect(requests.map(({ drag }) => drag === requests[0].drag)).toEqual([true, true]);
    expect(requests.map(({ fromRest }) => fromRest ?? false)).toEqual([false, false]);
    expect(shape.shownShapeOf.value).toBe("plan");
    expect(shape.isFinal.value).toBe(false);
    expect(plan.value.simulation!.injections[1].volumeMl).toBe(1);

    releaseVolume(1, 2);
    await rest();
    expect(plan.value.simulation!.injections.map(({ volumeMl }) => volumeMl)).toEqual([1, 2]);
    expect(requests[2].fromRest).toBe(true);
    expect(requests[2].injections).toEqual([volume(0, 1), volume(1, 2)]);
    expect(shape.isFinal.value).toBe(true);
    expect(shape.figures.value?.summary?.injectedMl).toBe(2);
  });
  it("keeps what the daemon has made as long as only volumes change", async () => {
    const ask = async (volumeMl: number): Promise<void> => {
      dragVolume(0, volumeMl);
      releaseVolume(0, volumeMl);
      await rest();
    };
    await ask(2);
    await ask(3);
    editPlan(({ simulation }) => (simulation!.fat!.viscosityPaS = 20));
    await ask(4);
    const [first, , second, , third] = requests;
    expect([second.drag, second.plan]).toEqual([first.drag, first.plan]);
    expect(third.drag).not.toBe(first.drag);
    expect(third.plan.case === "spec" && third.plan.value.fat?.viscosityPaS).toBe(20);
  });
  it("shows the shape until the plan is another one", async () => {
    dragVolume(0, 2);
    releaseVolume(0, 2);
    await rest();
    expect(shape.shownShapeOf.value).toBe("plan");
    editPlan(({ simulation }) => (simulation!.injections[1].volumeMl = 3));
    expect(shape.shownShapeOf.value).toBeUndefined();
    expect(shape.shapeFrame.value).toBeUndefined();
  });
  it("shows the shape until a run is opened", async () => {
    dragVolume(0, 2);
    releaseVolume(0, 2);
    await rest();
    run.simulation.value = create(SimulationSchema, { name: "simulations/s" });
    expect(shape.shapeOf.value).toBeUndefined();
  });
  it("still changes a plan that has to be stepped, and says so once", async () => {
    // eslint-disable-next-line require-yield
    answer = async function* () {
      throw new ConnectError("spec.fat.yield_stress_pa is 5 Pa", Code.FailedPrecondition);
    };
    for (const volume of [2, 3, 4]) {
      dragVolume(0, volume);
      await rest();
    }
    releaseVolume(0, 4);
    await rest();
    expect(requests).toHaveLength(1);
    expect(shape.refusal.value).toMatch(/has to be run.*yield_stress_pa/);
    expect(plan.value.simulation!.injections[0].volumeMl).toBe(4);
  });
  it("only changes the plan while there is no model", async () => {
    setModel(undefined, undefined);
    dragVolume(0, 2);
    releaseVolume(0, 2);
    await rest();
    expect(requests).toEqual([]);
    expect(shape.dragged.value.size).toBe(0);
    expect(plan.value.simulation!.injections[0].volumeMl).toBe(2);
  });
  it("reaches beyond what is planned", () => {
    expect([0, 4.5, 4.9, -9.8].map(mostOf)).toEqual([5, 5, 10, 20]);
  });
});

describe("fat added to a run", () => {
  it("is looked for in its zone, and no fat is no question", async () => {
    const requests: FindShapeRequest[] = [];
    vi.spyOn(simulations, "findShape").mockImplementation((request) => {
      requests.push(request as FindShapeRequest);
      return streamOf(found({ summary: {} }));
    });
    step.value = "run";
    run.simulation.value = create(SimulationSchema, {
      name: "simulations/s",
      state: Simulation_State.SETTLED,
      spec: { films: [{ name: "deep", zones: [{ name: "masseter" }] }] },
      summary: { zones: [{ name: "masseter", volumeMl: 3.02 }] },
    });
    added.dragAdded(-0.5);
    await rest();
    expect(requests[0].plan).toEqual({ case: "simulation", value: "simulations/s" });
    expect(requests[0].added).toEqual([{ zone: "masseter", volumeMl: -0.5 }]);
    expect([shape.shownShapeOf.value, added.inZone.value]).toEqual(["run", 3.02]);
    added.releaseAdded(0);
    await rest();
    expect(requests).toHaveLength(1);
    expect(shape.shownShapeOf.value).toBeUndefined();
    vi.restoreAllMocks();
  });
});
