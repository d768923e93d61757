// One question at a time, for answers that are only wanted while they are new.
import { Code, ConnectError } from "@connectrpc/connect";
import { toProblem } from "./errors";

export interface LatestListener<Question, Answer> {
  answered(answer: Answer, question: Question): void;
  /** told once while the same thing goes wrong again and again */
  failed(error: unknown, question: Question): void;
}

/**
 * Asks one question at a time. Of those that come meanwhile only the newest waits: what a hand
 * drags never makes a queue.
 */
export class Latest<Question, Answer> {
  private waiting: Question | undefined;
  private underWay: AbortController | undefined;
  private reported = "";

  constructor(
    private readonly ask: (question: Question, left: AbortSignal) => Promise<Answer>,
    private readonly listener: LatestListener<Question, Answer>,
  ) {}

  want(question: Question): void {
    this.waiting = question;
    if (this.underWay === undefined) void this.goOn();
  }

  /** Leaves what is under way, and forgets what waits. */
  forget(): void {
    this.underWay?.abort();
    [this.waiting, this.underWay, this.reported] = [undefined, undefined, ""];
  }

  private async goOn(): Promise<void> {
    const leave = new AbortController();
    this.underWay = leave;
    while (this.waiting !== undefined && !leave.signal.aborted) {
      const question = this.waiting;
      this.waiting = undefined;
      await this.settle(question, leave.signal);
    }
    if (this.underWay === leave) this.underWay = undefined;
  }

  private async settle(question: Question, left: AbortSignal): Promise<void> {
    try {
      const answer = await this.ask(question, left);
      if (left.aborted) return;
      this.reported = "";
      this.listener.answered(answer, question);
    } catch (error) {
      // A newer question took the place of this one.
      if (left.aborted || ConnectError.from(error).code === Code.Aborted) return;
      const { message } = toProblem(error);
      if (message === this.reported) return;
      this.reported = message;
      this.listener.failed(error, question);
    }
  }
}
