import { defineConfig, mergeConfig } from "vitest/config";
import page from "./vite.config";

export default mergeConfig(
  page,
  defineConfig({
    test: { include: ["tests/gateway/*.test.ts"], fileParallelism: false, testTimeout: 60_000, hookTimeout: 60_000 },
  }),
);
