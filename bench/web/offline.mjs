// SPDX-License-Identifier: Apache-2.0
// How long pages that turn (-o scene.html) take to open, and how fast they turn, in headless Chromium without a graphics card.
//
//   node bench/web/offline.mjs [--size 1280x720] [--seconds 4] PAGE.html ...
//
// Needs `npm ci` in web/ and Chromium.
import { statSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { fileURLToPath } from "node:url";

const { chromium } = createRequire(fileURLToPath(new URL("../../web/package.json", import.meta.url)))("playwright-core");

const words = process.argv.slice(2);
const option = (name, otherwise) => {
  const at = words.indexOf(name);
  return at < 0 ? otherwise : words.splice(at, 2)[1];
};
const [width, height] = option("--size", "1280x720").split("x").map(Number);
const seconds = Number(option("--seconds", "4"));
if (words.length === 0) {
  console.error("name a page: node bench/web/offline.mjs scene.html");
  process.exit(2);
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
for (const file of words) {
  const page = await browser.newPage({ viewport: { width, height } });
  const began = performance.now();
  await page.goto("file://" + resolve(file), { waitUntil: "commit" });
  await page.waitForFunction(() => window.sightglass || document.documentElement.dataset.state, null, { timeout: 120000 });
  const opened = performance.now() - began;
  await page.waitForFunction(() => document.documentElement.dataset.state, null, { timeout: 300000 });
  const still = performance.now() - began;
  const frames = await page.evaluate(async (seconds) => {
    const v = window.sightglass.viewer;
    const times = [];
    const start = performance.now();
    for (let last = start; last - start < seconds * 1000; ) {
      v.camera.turn(0.05, 0.02), v.draw(true);
      await new Promise(requestAnimationFrame);
      const now = performance.now();
      times.push(now - last), (last = now);
    }
    const settled = times.slice(times.length >> 2).sort((a, b) => a - b); // the first ones learn the pace
    return { median: settled[settled.length >> 1], slow: settled[Math.floor(0.95 * (settled.length - 1))] };
  }, seconds);
  console.log(`${file.split("/").pop()}: ${(statSync(file).size / 2 ** 20).toFixed(2)} MiB, opens in ${opened.toFixed(0)} ms, still after ${still.toFixed(0)} ms, turns at ${(1000 / frames.median).toFixed(1)} frames/s (95 %: ${(1000 / frames.slow).toFixed(1)})`);
  await page.close();
}
await browser.close();
