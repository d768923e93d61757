// The gateway: the page for browsers, and their calls for the daemon.
import { connectNodeAdapter } from "@connectrpc/connect-node";
import { writeFileSync } from "node:fs";
import { createServer, type IncomingMessage, type ServerResponse } from "node:http";
import type { AddressInfo } from "node:net";
import { CallerTransports } from "./callers";
import { refuseByHost, type Refusal } from "./hosts";
import { BodyRoom, mostConnections, mostMessageBytes, serverOptions } from "./limits";
import { help, parseOptions, UsageError, type Options } from "./options";
import { servePages } from "./pages";
import { connectDaemon, passOn } from "./passthrough";
import { Reports } from "./reports";

/** Refuses, and closes the connection: what else it sends is not read. */
function refuse(response: ServerResponse, { status, text }: Refusal): void {
  response.writeHead(status, { "content-type": "text/plain; charset=utf-8", connection: "close" }).end(`${text}\n`);
}

function serve(options: Options): void {
  const pages = servePages(options.page, options.samples);
  const reports = new Reports(options.reports, options.daemon, options.daemonCa);
  const calls = connectNodeAdapter({
    routes: passOn(new CallerTransports(() => connectDaemon(options.daemon, options.daemonCa))),
    readMaxBytes: mostMessageBytes,
    fallback: (request, response) => pages(request as IncomingMessage, response as ServerResponse),
  });
  const rules = { listen: options.host, names: options.hostNames };
  const room = new BodyRoom();
  const server = createServer(serverOptions, (request: IncomingMessage, response: ServerResponse) => {
    const refusal = refuseByHost(request, rules);
    if (refusal !== undefined) return refuse(response, refusal);
    if (!room.take(request, response))
      return refuse(response, { status: 503, text: "too much is being sent; try again" });
    if (!reports.take(request, response)) calls(request, response);
  });
  server.maxConnections = mostConnections;
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
    reports.end();
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
