// Whom a request is meant for, and which page made it: the headers Host, Origin and Sec-Fetch-*.
//
// A browser lets a page call its own site only. Two ways lead around that. A site elsewhere makes
// its own name point to this machine (rebinding), and its page then calls us as its own site: so
// Host must be an address, which no name server can change, or a name that is surely ours. And any
// page may send requests whose answer it cannot read: so Origin must be the site asked for.
import type { IncomingMessage } from "node:http";
import { isIP, isIPv4 } from "node:net";

export interface Refusal {
  status: number;
  text: string;
}

/** The host and port that a header names; port: undefined where it names none. */
export interface HostAndPort {
  host: string;
  port?: number;
}

/** Reads HOST, HOST:PORT, [IPV6] or [IPV6]:PORT, and nothing else: no user, no path, no space. */
export function parseHost(text: string): HostAndPort | undefined {
  const match = /^(?:\[([0-9a-fA-F:.]+)\]|([0-9a-zA-Z._-]+))(?::(\d{1,5}))?$/.exec(text);
  if (match === null || Number(match[3] ?? 0) > 65535) return undefined;
  const [, bracketed, plain, port] = match;
  if (bracketed !== undefined && isIP(bracketed) !== 6) return undefined;
  return { host: (bracketed ?? plain).toLowerCase(), ...(port === undefined ? {} : { port: Number(port) }) };
}

/** True for localhost and the addresses 127.0.0.0/8 and ::1, written out in full. */
export function isLoopback(host: string): boolean {
  if (host === "localhost" || host === "::1") return true;
  return isIPv4(host) && host.startsWith("127.");
}

/** Which hosts a request may be meant for. */
export interface HostRules {
  /** where the gateway listens; on a loopback address only this machine's browsers are served */
  listen: string;
  /** names by which browsers know the gateway, beside addresses */
  names: readonly string[];
}

function isOurs(host: string, rules: HostRules): boolean {
  if (rules.names.includes(host) || isLoopback(host)) return true;
  // Where others are served by address, an address is what the browser asked for: no name was made
  // to point there.
  return !isLoopback(rules.listen) && isIP(host) !== 0;
}

/** True when the origin is the site that Host names: one host, one port. */
function isSameSite(origin: string, host: string): boolean {
  try {
    const { protocol, host: from } = new URL(origin);
    return /^https?:$/.test(protocol) && from === new URL(`${protocol}//${host}`).host;
  } catch {
    return false;
  }
}

/** What browsers say of a request of another site's page, unless somebody followed a link. */
function isForeign(request: IncomingMessage): boolean {
  const site = request.headers["sec-fetch-site"];
  const isOwn = site === undefined || site === "same-origin" || site === "none";
  const isLink = request.headers["sec-fetch-mode"] === "navigate" && request.method === "GET";
  return !isOwn && !isLink;
}

/** Why a request is not served, or undefined when it is. Programs send no Origin, browsers do. */
export function refuseByHost(request: IncomingMessage, rules: HostRules): Refusal | undefined {
  const hosts = request.headersDistinct.host ?? [];
  const host = hosts.length === 1 ? parseHost(hosts[0]) : undefined;
  if (host === undefined || !isOurs(host.host, rules)) {
    return { status: 421, text: "ask for this machine by its address, or by a name given as --host-name" };
  }
  const { origin } = request.headers;
  if ((origin !== undefined && !isSameSite(origin, hosts[0])) || isForeign(request)) {
    return { status: 403, text: "this is served to its own page only: the request comes from another site's" };
  }
  return undefined;
}
