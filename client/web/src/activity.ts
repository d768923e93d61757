// What the page is doing at the moment, and what went wrong: of the plan and of the run alike.
import { signal } from "@preact/signals";
import { token } from "./api/client";
import { toProblem, type Problem } from "./api/errors";

export const problem = signal<Problem | undefined>(undefined);
export const notice = signal("");
/** what is worth knowing of what was just done, until it is dismissed */
export const remark = signal("");
export const busy = signal<{ label: string; share: number | undefined; cancel?: () => void } | undefined>(undefined);

type Tell = (share: number | undefined, label?: string) => void;

/**
 * Runs something that may take long or fail; says so on the page. Whether it went well.
 * @param work  with a signal that aborts where somebody cancels it, if `cancellable`
 */
export async function attempt(
  label: string,
  work: (progress: Tell, left: AbortSignal) => Promise<void>,
  cancellable = false,
): Promise<boolean> {
  const leave = new AbortController();
  const cancel = cancellable ? () => leave.abort() : undefined;
  busy.value = { label, share: undefined, cancel };
  problem.value = undefined;
  try {
    await work((share, now) => {
      if (!leave.signal.aborted) busy.value = { label: now ?? label, share, cancel };
    }, leave.signal);
    return true;
  } catch (error) {
    if (!leave.signal.aborted) tell(error);
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
