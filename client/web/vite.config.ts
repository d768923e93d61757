// The page: src/ to build/web/page. The wire's types come from the schema, see build.mjs.
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const here = (path: string): string => fileURLToPath(new URL(path, import.meta.url));

export default defineConfig({
  root: here("."),
  base: "./",
  resolve: { alias: { "@wire": here("../../build/web/wire/lipofill/v1"), "@google": here("../../build/web/wire/google") } },
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  cacheDir: here("../../build/web/vite-cache"),
  build: {
    outDir: here("../../build/web/page"),
    emptyOutDir: true,
    chunkSizeWarningLimit: 2500,
    reportCompressedSize: false,
  },
});
