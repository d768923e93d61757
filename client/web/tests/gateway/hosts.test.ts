import type { IncomingMessage } from "node:http";
import { describe, expect, it } from "vitest";
import { isLoopback, parseHost, refuseByHost } from "../../gateway/hosts";

const here = { listen: "127.0.0.1", names: [] };
const anywhere = { listen: "0.0.0.0", names: ["planner.example.org"] };

function asked(host: string | string[], headers: Record<string, string> = {}, method = "POST"): IncomingMessage {
  const hosts = Array.isArray(host) ? host : [host];
  return { method, headers: { host: hosts[0], ...headers }, headersDistinct: { host: hosts } } as never;
}
const status = (...request: Parameters<typeof asked>) => refuseByHost(asked(...request), here)?.status;

describe("a host", () => {
  it("is read whole or not at all", () => {
    expect(parseHost("LocalHost:80")).toEqual({ host: "localhost", port: 80 });
    expect(parseHost("[::1]")).toEqual({ host: "::1" });
    for (const text of ["", "127.0.0.1:80@evil.com", "a b", "a/b", "[::1", "[evil.com]:1", "a:", "a:123456", "a:70000"])
      expect(parseHost(text), text).toBeUndefined();
  });
  it("is this machine by its parsed address, not by how its name begins", () => {
    for (const host of ["127.0.0.1", "127.8.9.1", "::1", "localhost"]) expect(isLoopback(host), host).toBe(true);
    for (const host of ["127.evil.com", "127.0.0.1.evil.com", "127.1", "127.0.0.256", "0127.0.0.1", "128.0.0.1", ""])
      expect(isLoopback(host), host).toBe(false);
  });
});

// Each is read as this machine by some library, proxy or browser, and by none must it be here.
const lookalikes = [
  "[::1].evil.com",
  "[::1]evil.com",
  "[::1].",
  "[::1%25lo]",
  "[::1%lo]:80",
  "[::ffff:127.0.0.1]",
  "[::ffff:7f00:1]",
  "[0:0:0:0:0:0:0:1]",
  "[::127.0.0.1]",
  "[::]",
  "::1",
  "::1:80",
  "0.0.0.0",
  "0",
  "0x7f.1",
  "0x7f000001",
  "2130706433",
  "017700000001",
  "127.0.0.1.",
  "127.0.0.1..",
  "127.0.1",
  "127.0.0.1%00.evil.com",
  "127.0.0.1\u0000",
  "127.0.0.1,evil.com",
  "127.0.0.1, 127.0.0.1",
  "127.0.0.1;evil.com",
  "127.0.0.1#evil.com",
  "127.0.0.1?evil.com",
  "127.0.0.1\\evil.com",
  "127.0.0.1:",
  "127.0.0.1:80:80",
  "127.0.0.1:-1",
  "127.0.0.1:+80",
  "127.0.0.1:0x50",
  " 127.0.0.1",
  "127.0.0.1 ",
  "127.0.0.1\t",
  "１２７.0.0.1",
  "127。0。0。1",
  "localhost.",
  "localhost.evil.com",
  "evil.localhost",
  "localhost.localdomain",
  "localhost:80@evil.com",
  "evil.com@localhost",
  "user:pass@127.0.0.1",
  "loc\u0430lhost",
  "localhoſt",
  "xn--localhost-",
  "ip6-localhost",
  "http://127.0.0.1",
  "//127.0.0.1",
  "127.0.0.1/",
];

describe("a host that looks like this machine", () => {
  it("is not served", () => {
    for (const host of lookalikes) expect(status(host), JSON.stringify(host)).toBe(421);
  });
  it("is no origin of this machine's page either", () => {
    for (const host of ["[::1].evil.com", "localhost.evil.com", "evil.localhost", "localhost.", "127.0.0.1.evil.com"])
      expect(status("localhost", { origin: `http://${host}` }), host).toBe(403);
  });
});

describe("a request", () => {
  it("is served on this machine by loopback addresses", () => {
    for (const host of ["127.0.0.1", "127.0.0.1:8080", "localhost:9", "[::1]:8080"])
      expect(status(host)).toBeUndefined();
    for (const host of ["127.evil.com", "127.0.0.1.evil.com:80", "127.0.0.1:80@evil.com", "10.0.0.1", "evil.com"])
      expect(status(host), host).toBe(421);
    expect(status(["127.0.0.1", "evil.com"]), "two hosts").toBe(421);
  });
  it("is served elsewhere by addresses and by the names that were given", () => {
    for (const host of ["10.0.0.1:8080", "[fe80::1]", "planner.example.org:443", "localhost"])
      expect(refuseByHost(asked(host), anywhere), host).toBeUndefined();
    for (const host of ["evil.com", "10.0.0.1.evil.com"])
      expect(refuseByHost(asked(host), anywhere)?.status, host).toBe(421);
  });
  it("is served to its own page, and to programs", () => {
    expect(status("127.0.0.1:8080", { origin: "http://127.0.0.1:8080" })).toBeUndefined();
    expect(status("localhost:80", { origin: "http://localhost" })).toBeUndefined();
    expect(status("127.0.0.1:8080", { "sec-fetch-site": "same-origin" })).toBeUndefined();
    for (const origin of ["http://evil.com", "http://127.0.0.1:8081", "http://localhost:8080", "null", "", "file://"])
      expect(status("127.0.0.1:8080", { origin }), origin).toBe(403);
  });
  it("from another site's page is served where somebody followed a link, and nowhere else", () => {
    const link = { "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate" };
    expect(status("127.0.0.1", link, "GET")).toBeUndefined();
    expect(status("127.0.0.1", link, "POST")).toBe(403);
    expect(status("127.0.0.1", { "sec-fetch-site": "same-site", "sec-fetch-mode": "no-cors" }, "GET")).toBe(403);
  });
});
