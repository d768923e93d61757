// The gateway: the page for browsers, and their calls for the daemon.
import { connectNodeAdapter } from "@connectrpc/connect-node";
import { writeFileSync } from "node:fs";
import { createServer, type IncomingMessage, type ServerResponse } from "node:http";
import type { AddressInfo } from "node:net";
import { help, isLoopback, parseOptions, UsageError, type Options } from "./options";
import { servePages } from "./pages";
import { connectDaemon, passOn } from "./passthrough";

/** Names of this machine only: a page of another site that has its name point here gets nothing. */
function isMeant(request: IncomingMessage, options: Options): boolean {
  if (!isLoopback(options.host)) return true;
  const host = (request.headers.host ?? "").replace(/:\d+$/, "").replace(/^\[|\]$/g, "");
  return isLoopback(host);
}

function serve(options: Options): void {
  const pages = servePages(options.page, options.samples);
  const calls = connectNodeAdapter({
    routes: passOn(connectDaemon(options.daemon, options.daemonCa)),
    readMaxBytes: 4 << 20,
    fallback: (request, response) => pages(request as IncomingMessage, response as ServerResponse),
  });
  const server = createServer((request: IncomingMessage, response: ServerResponse) => {
    if (isMeant(request, options)) return calls(request, response);
    response.writeHead(421, { "content-type": "text/plain" }).end("ask for this machine by its own name\n");
  });
  server.on("error", (error: NodeJS.ErrnoException) => {
    const why = error.code === "EADDRINUSE" ? "is taken by another program" : error.message;
    console.error(`gateway: cannot listen on ${options.host}:${options.port}: ${why}`);
    process.exit(1);
  });
  server.listen(options.port, options.host, () => {
    const { port } = server.address() as AddressInfo;
    if (options.portFile) writeFileSync(options.portFile, `${port}\n`);
    const host = options.host.includes(":") ? `[${options.host}]` : options.host;
    console.log(`gateway: http://${host}:${port}/ for the daemon at ${options.daemon}`);
  });
  const end = (): void => {
    server.close(() => process.exit(0));
    server.closeAllConnections();
  };
  process.on("SIGTERM", end);
  process.on("SIGINT", end);
}

try {
  const options = parseOptions(process.argv.slice(2), process.env);
  if (options === "help") console.log(help);
  else serve(options);
} catch (error) {
  if (!(error instanceof UsageError)) throw error;
  console.error(`gateway: ${error.message}; see --help`);
  process.exit(2);
}
