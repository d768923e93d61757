// Builds the page and its gateway into build/web: types of the wire from the schema, a check of all
// types, the page, its files compressed, the gateway as one file. Packages are those that
// deploy/setup put into build/web/node_modules.
//
//   node client/web/build.mjs            all of it
//   node client/web/build.mjs --wire     only the types of the wire
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, gzipSync } from "node:zlib";

const source = fileURLToPath(new URL(".", import.meta.url));
const root = join(source, "../..");
const out = join(root, "build/web");
const run = (command, args) => execFileSync(command, args, { cwd: source, stdio: "inherit" });
const tool = (name) => join(out, "node_modules/.bin", name);

function makeWireTypes() {
  const schema = join(root, "proto/lipofill/v1");
  const files = readdirSync(schema).filter((name) => name.endsWith(".proto"));
  mkdirSync(join(out, "wire"), { recursive: true });
  run("protoc", [
    `--plugin=protoc-gen-es=${tool("protoc-gen-es")}`,
    `--es_out=${join(out, "wire")}`,
    "--es_opt=target=ts",
    `-I${join(root, "proto")}`,
    ...files.map((name) => join(schema, name)),
    join(root, "proto/google/rpc/error_details.proto"),
    join(root, "proto/google/rpc/status.proto"),
  ]);
}

/** Scripts and styles also as browsers take them: the gateway sends those. */
function compressPage() {
  const assets = join(out, "page/assets");
  for (const name of readdirSync(assets).filter((one) => /\.(js|css)$/.test(one))) {
    const bytes = readFileSync(join(assets, name));
    writeFileSync(join(assets, `${name}.br`), brotliCompressSync(bytes));
    writeFileSync(join(assets, `${name}.gz`), gzipSync(bytes, { level: 9 }));
  }
}

async function bundleGateway() {
  const { build } = await import("esbuild");
  await build({
    absWorkingDir: source,
    entryPoints: ["gateway/main.ts"],
    outfile: join(out, "gateway.mjs"),
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node18",
    alias: { "@wire": join(out, "wire/lipofill/v1") },
    logLevel: "warning",
  });
}

makeWireTypes();
if (!process.argv.includes("--wire")) {
  run(tool("tsc"), ["--noEmit"]);
  run(tool("vite"), ["build", "--logLevel", "warn"]);
  compressPage();
  await bundleGateway();
  writeFileSync(join(out, "built"), `${new Date().toISOString()}\n`);
}
