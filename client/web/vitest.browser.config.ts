import { defineConfig, mergeConfig } from "vitest/config";
import page from "./vite.config";

// One after the other: they share the machine's cores with the daemon and a browser without a
// graphics card.
export default mergeConfig(
  page,
  defineConfig({
    test: {
      include: ["tests/browser/*.test.ts"],
      fileParallelism: false,
      testTimeout: 90_000,
      bail: 1,
      hookTimeout: 90_000,
    },
  }),
);
