// SPDX-License-Identifier: Apache-2.0
// Browser, server and small helpers of the tests of the window.
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

const root = resolve(import.meta.dirname, "../..");
const require = createRequire(join(root, "web/package.json"));
export const { chromium } = require("playwright-core");
export const { AxeBuilder } = require("@axe-core/playwright");

export function options() {
  const list = process.argv.slice(2);
  const value = (name) => (list.includes(`--${name}`) ? list[list.indexOf(`--${name}`) + 1] : undefined);
  return {
    mock: list.includes("--mock"),
    url: value("url"),
    program: resolve(value("program") ?? join(root, "build/sightglass")),
    data: value("data"),
    series: value("series"),
    shots: value("shots"),
    only: value("only"),
    dist: list.includes("--dist"),
  };
}

const started = [];
const scratch = mkdtempSync(join(tmpdir(), "window-test-"));

/** A file for the tests: the one that was named, or a computed volume. */
export function dataFile(o) {
  if (o.data) return o.data;
  const file = join(scratch, "orbital.vti");
  if (!existsSync(file)) execFileSync(o.program, ["convert", "--source", "hydrogen size=48", "-o", file], { stdio: "ignore" });
  return file;
}

/** The square [-1,1]^2 in the plane z = 0, in 32 by 32 cells. */
export function flatFile(o) {
  const file = join(scratch, "square.vtp");
  if (!existsSync(file)) execFileSync(o.program, ["convert", "--source", "sphere size=33 radius=0.7692307692307693", "-f", "slice axis=z position=0", "-o", file], { stdio: "ignore" });
  return file;
}

/** A ball, as a surface. */
export function ballFile(o) {
  const file = join(scratch, "ball.vtp");
  if (!existsSync(file)) execFileSync(o.program, ["convert", "--source", "sphere size=33", "-f", "contour values=0", "-o", file], { stdio: "ignore" });
  return file;
}

/** A series of three files, as a pattern. */
export function seriesFile(o) {
  if (o.series) return o.series;
  for (const n of [0, 1, 2]) {
    const file = join(scratch, `wave_${n}.vti`);
    if (!existsSync(file)) execFileSync(o.program, ["convert", "--source", `gyroid size=24 period=${1 + n / 4}`, "-o", file], { stdio: "ignore" });
  }
  return join(scratch, "wave_*.vti");
}

/** Starts a server on a file; returns its address and how to stop it. */
export async function serve(o, file, env = {}) {
  if (o.url) return { url: o.url, stop: () => undefined };
  const port = 20000 + Math.floor(Math.random() * 20000);
  const command = o.mock
    ? [process.execPath, join(root, "web/window/mock/server.mjs"), "--program", o.program, "--port", String(port), file]
    : [o.program, ...(env.SERVE ? ["serve", file] : ["view", file, "--no-browser"]), "--port", String(port)];
  const child = spawn(command[0], command.slice(1), { env: { ...process.env, ...env }, stdio: ["ignore", "pipe", "pipe"] });
  started.push(child);
  let printed = "";
  const url = await new Promise((found, failed) => {
    const timer = setTimeout(() => failed(new Error(`no address was printed: ${printed}`)), 30000);
    const read = (bytes) => {
      printed += bytes;
      const m = /https?:\/\/[^\s'"]+/.exec(printed);
      if (!m) return;
      clearTimeout(timer);
      found(m[0]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    child.on("exit", (code) => failed(new Error(`the server ended with ${code}: ${printed}`)));
  });
  return { url, stop: () => child.kill() };
}

export function cleanUp() {
  for (const child of started) child.kill();
  rmSync(scratch, { recursive: true, force: true });
}

// Chromium takes pages whose files a test hands over for pages from elsewhere, which may not talk to this machine.
export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-features=LocalNetworkAccessChecks"] });

/** A page whose errors, and what the content security policy refuses, are kept in `page.faults`. */
export async function openPage(browser, url, settings = {}, ready = settled) {
  const context = await browser.newContext({ viewport: { width: 1024, height: 640 }, acceptDownloads: true, ...settings });
  if (options().dist) await ownPage(context);
  const page = await context.newPage();
  page.faults = [];
  page.on("pageerror", (e) => page.faults.push(e.message));
  page.on("console", (m) => m.type() === "error" && !/WebSocket|ERR_/.test(m.text()) && page.faults.push(m.text()));
  await page.goto(url);
  await ready(page);
  return page;
}

/** Serves the page's files from this checkout, under the policy that the server sends, so that a new build needs no new program. */
export async function ownPage(context) {
  const dist = join(root, "web/dist/window");
  const types = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" };
  const policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; font-src 'self'";
  const send = (route, name) =>
    route.fulfill({ status: 200, contentType: types[name.split(".").pop()], headers: { "Content-Security-Policy": policy }, body: readFileSync(join(dist, name)) });
  await context.route(/\/assets\/[\w.]+$/, (route) => send(route, new URL(route.request().url()).pathname.slice(1)));
  await context.route(/^http:\/\/[^/]+\/(\?(open|below)=.*)?$/, (route) => send(route, "index.html"));
}

/** Waits until every view shows the final picture of what was asked last. */
export async function settled(page, seconds = 25) {
  await page.waitForFunction(() => document.querySelector(".refining") && !document.querySelector(".refining.on"), null, { timeout: seconds * 1000 });
}

/** Does something that changes the picture, and waits for the final one. */
export async function andSettle(page, act) {
  await act();
  await page.waitForTimeout(250);
  await settled(page);
}

/** A number for what the canvas of a view shows, and how many different colours it has. */
export function seen(page, view = 0) {
  return page.evaluate((i) => {
    const c = document.querySelectorAll(".view canvas")[i];
    const { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height);
    let sum = 0;
    const colors = new Set();
    for (let k = 0; k < data.length; k += 4 * 7) {
      sum = (Math.imul(sum, 31) + data[k] * 65536 + data[k + 1] * 256 + data[k + 2]) | 0;
      colors.add((data[k] >> 4) * 256 + (data[k + 1] >> 4) * 16 + (data[k + 2] >> 4));
    }
    return { sum, colors: colors.size };
  }, view);
}

export async function dragOn(page, from, by, steps = 12) {
  await page.mouse.move(from[0], from[1]);
  await page.mouse.down();
  for (let i = 1; i <= steps; i++) {
    await page.mouse.move(from[0] + (by[0] * i) / steps, from[1] + (by[1] * i) / steps);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
}

export async function middleOf(locator) {
  const b = await locator.boundingBox();
  return [b.x + b.width / 2, b.y + b.height / 2];
}

let shots = 0;
export async function shot(o, page, name) {
  if (!o.shots) return;
  mkdirSync(o.shots, { recursive: true });
  await page.screenshot({ path: join(o.shots, `${String(++shots).padStart(2, "0")}_${name}.png`) });
}
