// SPDX-License-Identifier: Apache-2.0
// Builds the browser window into dist/window. Names are fixed, so that a build changes only the files whose content changed; the server
// sends them with an ETag instead of relying on hashes in names.
import { defineConfig } from "vite";

export default defineConfig({
  root: "window",
  base: "/",
  build: {
    outDir: "../dist/window",
    emptyOutDir: true,
    target: "es2022",
    modulePreload: false, // its polyfill would be an inline script, which the content security policy forbids
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: {
        entryFileNames: "assets/window.js",
        chunkFileNames: "assets/[name].js",
        assetFileNames: "assets/[name][extname]",
      },
    },
  },
});
