// What the page is doing at the moment, and what went wrong: of the plan and of the run alike.
import { signal } from "@preact/signals";
import { token } from "./api/client";
import { toProblem, type Problem } from "./api/errors";

export const problem = signal<Problem | undefined>(undefined);
export const notice = signal("");
export const busy = signal<{ label: string; share: number | undefined } | undefined>(undefined);

/** Runs something that may take long or fail; says so on the page. Whether it went well. */
export async function attempt(
  label: string,
  work: (progress: (share: number, label?: string) => void) => Promise<void>,
): Promise<boolean> {
  busy.value = { label, share: undefined };
  problem.value = undefined;
  try {
    await work((share, now) => (busy.value = { label: now ?? label, share }));
    return true;
  } catch (error) {
    tell(error);
    return false;
  } finally {
    busy.value = undefined;
  }
}

/** Shows what went wrong until it is dismissed. */
export function tell(error: unknown): void {
  problem.value = toProblem(error);
  if (problem.value.unknownCaller)
    notice.value = token.value ? "The token is not accepted." : "The daemon asks who you are: give a token.";
}
