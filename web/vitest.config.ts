// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from "vitest/config";

export default defineConfig({ test: { include: ["window/test/**/*.test.ts", "offline/test/**/*.test.ts"] } });
