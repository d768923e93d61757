// The page: src/ to build/web/page. The wire's types come from the schema, see build.mjs.
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const here = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

/** Old ways to the global object, which the page's policy refuses, in packages of packages. */
const withoutEval = {
  name: "without-eval",
  transform: (code: string, id: string) =>
    id.includes("node_modules") && /Function\(["']return this["']\)/.test(code)
      ? { code: code.replace(/(?:new )?Function\(["']return this["']\)\(\)/g, "globalThis"), map: null }
      : undefined,
};

export default defineConfig({
  plugins: [withoutEval],
  root: here("."),
  base: "./",
  resolve: {
    alias: { "@wire": here("../../build/web/wire/lipofill/v1"), "@google": here("../../build/web/wire/google") },
  },
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  cacheDir: here("../../build/web/vite-cache"),
  build: {
    outDir: here("../../build/web/page"),
    emptyOutDir: true,
    chunkSizeWarningLimit: 2500,
    reportCompressedSize: false,
  },
});
