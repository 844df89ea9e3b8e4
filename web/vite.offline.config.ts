// SPDX-License-Identifier: Apache-2.0
// The program of offline pages as one script: web/dist/offline.js, which the C++ build compiles in.
import { defineConfig } from "vitest/config";

export default defineConfig({
  build: {
    outDir: "dist",
    emptyOutDir: false,
    target: "es2022",
    minify: "esbuild",
    lib: { entry: "offline/src/main.ts", formats: ["iife"], name: "sightglass", fileName: () => "offline.js" },
  },
  test: { include: ["offline/test/**/*.test.ts"] },
});
