// Files that browsers get: the built page, and the sample faces and plans.
import { createReadStream } from "node:fs";
import { stat } from "node:fs/promises";
import type { IncomingMessage, ServerResponse } from "node:http";
import { extname, join, normalize, sep } from "node:path";
import { pipeline } from "node:stream/promises";

const types: Record<string, string> = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".json": "application/json",
  ".svg": "image/svg+xml",
  ".png": "image/png",
  ".obj": "text/plain; charset=utf-8",
};

// The page runs what came with it, and nothing else.
const policy =
  "default-src 'self'; script-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; " +
  "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/** A file below `folder` by its path in the address; undefined where the path leads out of it. */
export function locate(folder: string, path: string): string | undefined {
  let decoded: string;
  try {
    decoded = decodeURIComponent(path);
  } catch {
    return undefined;
  }
  if (decoded.includes("\0")) return undefined;
  const file = normalize(join(folder, decoded));
  return file.startsWith(folder + sep) ? file : undefined;
}

function refuse(response: ServerResponse, status: number, text: string): void {
  response.writeHead(status, { "content-type": "text/plain; charset=utf-8" });
  response.end(`${text}\n`);
}

/** Of the best first: the ending of the file beside a file that is the same, compressed. */
const compressions = [
  { encoding: "br", ending: ".br" },
  { encoding: "gzip", ending: ".gz" },
];

/** Whether a client takes an encoding (RFC 9110, 12.5.3); one with weight 0 it does not. */
export function takesEncoding(header: string | undefined, encoding: string): boolean {
  const offers = (header ?? "").split(",").map((offer) =>
    offer
      .trim()
      .toLowerCase()
      .split(/\s*;\s*/),
  );
  const own = offers.find(([name]) => name === encoding) ?? offers.find(([name]) => name === "*");
  return own !== undefined && !own.slice(1).some((weight) => /^q=0(\.0*)?$/.test(weight));
}

interface Found {
  path: string;
  size: number;
  encoding?: string;
}

/** The file, or the same compressed where that was made with the page and the client takes it. */
async function find(file: string, accepted: string | undefined): Promise<Found | undefined> {
  const plain = await stat(file).catch(() => undefined);
  if (!plain?.isFile()) return undefined;
  for (const { encoding, ending } of compressions) {
    if (!takesEncoding(accepted, encoding)) continue;
    const small = await stat(file + ending).catch(() => undefined);
    if (small?.isFile()) return { path: file + ending, size: small.size, encoding };
  }
  return { path: file, size: plain.size };
}

async function sendFile(file: string, request: IncomingMessage, response: ServerResponse): Promise<void> {
  const accepted = request.headers["accept-encoding"];
  const found = await find(file, Array.isArray(accepted) ? accepted.join(",") : accepted);
  if (found === undefined) return refuse(response, 404, "not found");
  const lasting = file.includes("/assets/"); // named by their content
  response.writeHead(200, {
    "content-type": types[extname(file)] ?? "application/octet-stream",
    "content-length": found.size,
    ...(found.encoding === undefined ? {} : { "content-encoding": found.encoding }),
    vary: "accept-encoding",
    "cache-control": lasting ? "public, max-age=31536000, immutable" : "no-cache",
    "content-security-policy": policy,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
  });
  if (request.method === "HEAD") {
    response.end();
    return;
  }
  // Whoever does not read lets the file go.
  response.setTimeout(60_000, () => response.destroy());
  await pipeline(createReadStream(found.path), response).catch(() => response.destroy());
}

export function servePages(page: string, samples: string) {
  return (request: IncomingMessage, response: ServerResponse): void => {
    if (request.method !== "GET" && request.method !== "HEAD") return refuse(response, 405, "only GET");
    const path = (request.url ?? "/").split("?")[0];
    const sample = path.startsWith("/samples/") && samples !== "";
    const file = sample
      ? locate(samples, path.slice("/samples/".length))
      : locate(page, path === "/" ? "/index.html" : path);
    if (file === undefined) return refuse(response, 404, "not found");
    void sendFile(file, request, response);
  };
}
