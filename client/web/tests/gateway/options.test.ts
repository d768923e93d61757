import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import { help, parseOptions } from "../../gateway/options";
import { locate, takesEncoding } from "../../gateway/pages";

const page = mkdtempSync(join(tmpdir(), "page-"));
writeFileSync(join(page, "index.html"), "");
const parse = (...args: string[]) => parseOptions(["--page", page, ...args], {});

describe("the gateway's options", () => {
  it("listen on this machine only, unless told", () => {
    expect(parse()).toMatchObject({ host: "127.0.0.1", port: 8080, daemon: "127.0.0.1:50061" });
    expect(() => parse("--listen", "0.0.0.0:80")).toThrow(/--listen is '0.0.0.0:80'.*plain text/);
    expect(parse("--listen", "0.0.0.0:80", "--insecure-listen-anywhere")).toMatchObject({ host: "0.0.0.0" });
    expect(parse("--listen", "[::1]:0")).toMatchObject({ host: "::1", port: 0 });
    expect(() => parse("--listen", "127.evil.com:80")).toThrow(/--listen is '127.evil.com:80'.*plain text/);
  });
  it("name what is wrong", () => {
    expect(() => parse("--listen", "8080")).toThrow(/--listen is '8080', must be HOST:PORT/);
    expect(() => parse("--daemon", "nowhere")).toThrow(/--daemon is 'nowhere'/);
    expect(() => parse("--daemon-ca", "/nowhere.pem")).toThrow(/--daemon-ca is '\/nowhere.pem'/);
    expect(() => parse("--host-name", "a.example:80")).toThrow(/--host-name is 'a.example:80', must be a name without/);
    expect(() => parse("--reports", "/nowhere")).toThrow(/--reports is '\/nowhere', which is not there/);
    expect(() => parse("--port", "1")).toThrow(/--port/);
    expect(() => parseOptions(["--page", "/nowhere"], {})).toThrow(/--page is '\/nowhere'/);
  });
  it("take the daemon from the environment as the command line does", () => {
    expect(parseOptions(["--page", page], { LIPOFILL_SERVER: "unix:/run/x" })).toMatchObject({ daemon: "unix:/run/x" });
  });
  it("are all in the help", () => {
    for (const option of [
      "listen",
      "daemon",
      "daemon-ca",
      "page",
      "samples",
      "port-file",
      "host-name",
      "insecure-listen-anywhere",
      "reports",
    ])
      expect(help).toContain(`--${option}`);
    expect(parse("--help")).toBe("help");
  });
});

describe("a file of the page", () => {
  it("is found below its folder and nowhere else", () => {
    expect(locate("/srv/page", "/assets/a.js")).toBe("/srv/page/assets/a.js");
    for (const path of ["/../secret", "/%2e%2e/secret", "/..%2fsecret", "/a/../../secret", "/%00", "/%zz"])
      expect(locate("/srv/page", path)).toBeUndefined();
  });
});

describe("what a client takes", () => {
  it("is what its header says", () => {
    expect(takesEncoding("gzip, deflate, br", "br")).toBe(true);
    expect(takesEncoding("*", "br")).toBe(true);
    expect(takesEncoding("br;q=0.5", "br")).toBe(true);
    for (const header of [undefined, "", "gzip", "br;q=0, *", "br; q=0.0"])
      expect(takesEncoding(header, "br")).toBe(false);
  });
});
