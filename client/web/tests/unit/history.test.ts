import { describe, expect, it } from "vitest";
import { History } from "../../src/plan/history";

describe("what was changed", () => {
  it("is taken back and done again, in order", () => {
    const history = new History<string>();
    expect(history.canUndo).toBe(false);
    history.add("a"); // now b
    history.add("b"); // now c
    expect(history.undo("c")).toBe("b");
    expect(history.undo("b")).toBe("a");
    expect(history.undo("a")).toBeUndefined();
    expect(history.redo("a")).toBe("b");
    expect(history.redo("b")).toBe("c");
    expect(history.canRedo).toBe(false);
  });
  it("is a stroke as a whole, and another stroke by itself", () => {
    const history = new History<string>();
    const [first, second] = [{}, {}];
    history.add("a", first);
    history.add("b", first);
    history.add("c", second);
    expect(history.undo("d")).toBe("c");
    expect(history.undo("c")).toBe("a");
  });
  it("begins anew where a stroke was taken back", () => {
    const history = new History<string>();
    const stroke = {};
    history.add("a", stroke);
    history.undo("b");
    history.add("a", stroke);
    expect(history.undo("c")).toBe("a");
  });
  it("cannot be done again once something else is done", () => {
    const history = new History<string>();
    history.add("a");
    history.undo("b");
    history.add("a");
    expect(history.canRedo).toBe(false);
  });
  it("is bounded: the oldest goes first", () => {
    const history = new History<number>();
    for (let k = 0; k < 150; ++k) history.add(k);
    let oldest = 150;
    for (let now = 150; history.canUndo; now = oldest) oldest = history.undo(now)!;
    expect(oldest).toBe(50);
  });
});
