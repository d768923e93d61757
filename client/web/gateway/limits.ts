// What one caller may cost: time to send a request, room for its headers and its body.
import type { IncomingMessage, ServerOptions, ServerResponse } from "node:http";

/** Largest message that is taken, as the daemon's. */
export const mostMessageBytes = 4 << 20;

/** All headers of a request together; a token has at most 8 KiB. More is answered with 431. */
const mostHeaderBytes = 16 << 10;
/** Within this a connection must have sent a request's headers, whether it has begun or not. */
const headersMs = 10_000;
/** Within this it must have sent all of the request; a chunk of a scan has 1 MiB. */
const requestMs = 60_000;
/** A connection that has been answered is kept so long for the next request. */
const keepAliveMs = 10_000;
/** How often the times above are looked at. */
const lookEveryMs = 1_000;

export const serverOptions: ServerOptions = {
  maxHeaderSize: mostHeaderBytes,
  headersTimeout: headersMs,
  requestTimeout: requestMs,
  keepAliveTimeout: keepAliveMs,
  connectionsCheckingInterval: lookEveryMs,
};

/** Connections at once: well below the files a process may usually open, also to the daemon. */
export const mostConnections = 512;

/** What a request's body may come to: its length where it says so, else the most that is taken. */
function bodyBytes(request: IncomingMessage): number {
  const length = Number(request.headers["content-length"] ?? NaN);
  if (!Number.isNaN(length)) return Math.min(length, mostMessageBytes);
  return request.headers["transfer-encoding"] === undefined ? 0 : mostMessageBytes;
}

/** The room that bodies may take together, from their headers until they are answered. */
export class BodyRoom {
  private taken = 0;

  constructor(private readonly most = 256 << 20) {}

  /** Takes room for the request's body until it is answered or lost; false when there is none. */
  take(request: IncomingMessage, response: ServerResponse): boolean {
    let held = bodyBytes(request);
    if (this.taken + held > this.most) return false;
    this.taken += held;
    const keep = (bytes: number): void => {
      this.taken += bytes - held;
      held = bytes;
    };
    const { socket } = request;
    const before = socket.bytesRead;
    // One that did not say its length takes what it came to; the first part came with the headers.
    request.once("end", () => keep(Math.min(held, socket.bytesRead - before + mostHeaderBytes)));
    response.once("close", () => keep(0));
    return true;
  }
}
