// The gateway takes an order for a report, and makes a message of the program's words.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { messageIn, readOrder } from "../../gateway/reports";
import { root } from "../system/system";

const plan = JSON.parse(readFileSync(join(root, "client/examples/plans/jaw_angle.json"), "utf8")) as object;
const order = (more: object): ReturnType<typeof readOrder> =>
  readOrder(JSON.stringify({ plan, face: "v 0 0 0", ...more }));

describe("an order", () => {
  it("has the plan with its surface beside it, and names no other file", () => {
    const bone = { file: "/etc/passwd" };
    const scan = { file: "../../secret.obj", landmarks_file: "/etc/hosts" };
    const made = JSON.parse(order({ plan: { ...plan, bone, scan } }).plan) as Record<string, unknown>;
    expect(made.bone).toBeUndefined();
    expect(made.scan).toEqual({ file: "face.obj", unit: "MILLIMETRE" });
    expect(JSON.stringify(made)).not.toMatch(/passwd|secret|hosts/);
  });

  it("becomes words of the command that it cannot choose freely", () => {
    expect(order({}).options).toEqual(["--language", "en", "--paper", "a4", "--retention", "pooled", "--no-forecast"]);
    const all = order({ goal: "v 1 1 1", pseudonym: "case-7", language: "de", paper: "letter", members: 100 });
    expect(all.options.join(" ")).toBe(
      "--language de --paper letter --retention pooled --pseudonym=case-7 --target goal.obj --in-place --members 100",
    );
  });

  it("is refused with the field, its value and what it must be", () => {
    expect(() => readOrder("{")).toThrow("not JSON");
    expect(() => order({ plan: { nothing: 1 } })).toThrow(/plan is not a plan: .*nothing/);
    expect(() => order({ face: undefined })).toThrow("face is missing");
    expect(() => order({ face: 7 })).toThrow("face must be a text");
    expect(() => order({ language: "--out" })).toThrow('language is "--out", must be one of en, de');
    expect(() => order({ paper: "a0" })).toThrow('paper is "a0", must be one of a4, letter');
    expect(() => order({ pseudonym: "Mrs. Smith" })).toThrow(/pseudonym is "Mrs. Smith", must have at most 63/);
    for (const members of [49, 10001, 60.5, "100", {}])
      expect(() => order({ members })).toThrow(/members is .*, must be a whole number in \[50, 10000\]/);
    expect(() => order({ plan: { ...plan, parts: [{ name: "left" }] } })).toThrow("several parts");
  });
});

describe("what the program said", () => {
  it("is its error, else its last words", () => {
    expect(messageIn('building\n{"error":{"code":"NOT_FOUND","message":"no such zone"}}\n')).toBe("no such zone");
    expect(messageIn("first\nlast\n")).toBe("last");
    expect(messageIn("")).toBe("");
  });
});
