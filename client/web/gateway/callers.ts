// A connection to the daemon for each caller, so that what one of them does to it - more streams
// than it has, a header that the daemon ends the connection for - is theirs alone.
import { createHash } from "node:crypto";
import type { Transport } from "@connectrpc/connect";

interface Held {
  transport: Transport;
  calls: number;
}

/**
 * Callers are told apart by their credentials. So many have a connection of their own; when all of
 * those are in use, further ones share, each always the same.
 */
export class CallerTransports {
  private readonly held = new Map<string, Held>();

  constructor(
    private readonly connect: () => Transport,
    private readonly most = 64,
  ) {}

  /** Hands the caller's transport to a call, and knows until `release` that it is in use. */
  take(credentials: string): { transport: Transport; release: () => void } {
    const key = createHash("sha256").update(credentials).digest("hex");
    const held = this.find(key);
    ++held.calls;
    return { transport: held.transport, release: () => void --held.calls };
  }

  private find(key: string): Held {
    const known = this.held.get(key);
    if (known !== undefined) {
      // The one used last stands last: the first is the one to go.
      this.held.delete(key);
      this.held.set(key, known);
      return known;
    }
    if (this.held.size >= this.most && !this.dropIdle()) {
      return [...this.held.values()][parseInt(key.slice(0, 8), 16) % this.held.size];
    }
    const made = { transport: this.connect(), calls: 0 };
    this.held.set(key, made);
    return made;
  }

  /** Forgets the caller who has been away longest; the transport closes by itself when idle. */
  private dropIdle(): boolean {
    for (const [key, { calls }] of this.held) {
      if (calls > 0) continue;
      this.held.delete(key);
      return true;
    }
    return false;
  }
}
