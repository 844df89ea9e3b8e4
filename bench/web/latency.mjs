// SPDX-License-Identifier: Apache-2.0
// How long a person waits for pictures of `sightglass view`, measured in headless Chromium on this machine: to the first picture, from a drag
// and from an edit to the picture drawn on a canvas, from rest to all pixels and to the exact picture; and the server's memory over many.
//
//   node bench/web/latency.mjs [--program build/sightglass] [--frames 200] [--size 1280x720] FILE ['--show' 'volume ...' ...]
//
// What stands behind FILE goes to `sightglass view`. Needs `npm ci` in web/ and Chromium.
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const { chromium } = createRequire(fileURLToPath(new URL("../../web/package.json", import.meta.url)))("playwright-core");

const words = process.argv.slice(2);
const option = (name, otherwise) => {
  const at = words.indexOf(name);
  return at < 0 ? otherwise : words.splice(at, 2)[1];
};
const program = option("--program", "build/sightglass");
const frames = Number(option("--frames", "200"));
const size = option("--size", "1280x720").split("x").map(Number);
if (words.length === 0) {
  console.error("name a file: node bench/web/latency.mjs FILE");
  process.exit(2);
}

const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: size[0], height: size[1] } });
// When what happens on the way to the first painted picture is told by the page: looking at its pixels again and again would slow it down.
await page.addInitScript(() => {
  window.when = { page: performance.timeOrigin };
  const note = (what) => (window.when[what] ??= Date.now());
  window.WebSocket = class extends WebSocket {
    constructor(...words) {
      note("script");
      super(...words);
      this.addEventListener("open", () => note("socket"));
      this.addEventListener("message", ({ data }) => note(typeof data === "string" ? JSON.parse(data).is : "frame"));
    }
    send(words) {
      note(JSON.parse(words).do);
      super.send(words);
    }
  };
  const drawImage = CanvasRenderingContext2D.prototype.drawImage;
  CanvasRenderingContext2D.prototype.drawImage = function (...words) {
    drawImage.apply(this, words);
    if (!(words[0] instanceof ImageBitmap)) return; // the canvas itself, enlarged
    CanvasRenderingContext2D.prototype.drawImage = drawImage;
    requestAnimationFrame(() => setTimeout(() => note("painted")));
  };
});
const began = Date.now();
let listening;
const server = spawn(program, ["view", "--no-browser", ...words], { stdio: ["ignore", "pipe", "inherit"] });
process.on("exit", () => server.kill());
const address = await new Promise((found, lost) => {
  let said = "";
  server.stdout.on("data", (text) => {
    said += text;
    const at = said.match(/http:\S+/);
    if (at) (listening ??= Date.now() - began), found(at[0]);
  });
  server.on("exit", (code) => lost(new Error(`sightglass view ended with ${code}`)));
});
const memory = () => Number(readFileSync(`/proc/${server.pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1024;

// The token's page leads to the window; what is measured there is a client of its own, drawn as the window draws.
await page.goto(address);
await page.waitForFunction(() => window.when.painted, null, { polling: 50 });
const when = await page.evaluate(() => window.when);
const first = when.painted - began;
const parts = [["the server listens", listening], ...[
  ["page", "the browser asks for the window"],
  ["script", "its script asks for a picture"],
  ["socket", "its socket is open"],
  ["frame", "the picture has come"],
  ["painted", "and is on the screen"],
  ["state", "the state has come"],
].map(([key, words]) => [words, when[key] - began])];
const blank = await page.evaluate(() => {
  const c = document.querySelector("canvas");
  return !c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some((v, i) => i % 4 < 3 && v > 0 && v < 250);
});
if (blank) throw new Error("the first picture is blank");
await page.goto("about:blank");
await page.goto(new URL("/catalog.json", address).href); // same origin and cookie, and no window that draws as well

const client = async ({ size, frames }) => {
  const canvas = Object.assign(document.createElement("canvas"), { width: size[0], height: size[1] });
  const context = canvas.getContext("2d", { alpha: false });
  const socket = new WebSocket(`ws://${location.host}/socket`);
  socket.binaryType = "arraybuffer";
  await new Promise((opened) => (socket.onopen = opened));
  let shown = () => {}, n = 0, state = null, whole = 0;
  socket.onmessage = async ({ data }) => {
    if (typeof data === "string") {
      const m = JSON.parse(data);
      if (m.is === "state") state = m;
      return;
    }
    const head = new DataView(data).getUint32(0, true);
    const frame = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, head)));
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(data, 4 + head)], { type: frame.type }));
    const [x, y, w, h] = frame.part ? frame.area : [0, 0, ...size];
    context.drawImage(bitmap, x, y, w, h);
    if (!frame.part) whole = frame.revision;
    socket.send(JSON.stringify({ do: "shown", n: frame.n, view: 0, base: whole }));
    shown(frame);
  };
  const until = (good) => new Promise((done) => (shown = (frame) => good(frame) && done(frame)));
  const draw = (more) => socket.send(JSON.stringify({ do: "draw", n: ++n, view: 0, size, scale: 1, base: whole, ...more }));
  const median = (list, share = 0.5) => list.sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];

  draw({ moving: false });
  const still = await until((f) => f.coarse === 1);
  const c = still.camera;
  const turned = (degrees) => {
    const a = (degrees * Math.PI) / 180, x = c.position[0] - c.target[0], y = c.position[1] - c.target[1];
    const position = [c.target[0] + x * Math.cos(a) - y * Math.sin(a), c.target[1] + x * Math.sin(a) + y * Math.cos(a), c.position[2]];
    return { ...c, position };
  };
  const drags = [], coarse = [];
  for (let i = 1; i <= frames; ++i) {
    if (i % 1000 === 1) await window.noteMemory(i - 1);
    const begin = performance.now();
    draw({ camera: turned(3 * i), moving: true });
    const frame = await until((f) => f.n === n);
    if (i > 5) drags.push(performance.now() - begin), coarse.push(frame.coarse); // the first ones learn the pace
  }
  await window.noteMemory(frames);
  const rest = performance.now();
  draw({ camera: turned(3 * frames), moving: false });
  await until((f) => f.n === n && f.coarse === 1);
  const all = performance.now() - rest;
  while (!state) await new Promise((r) => setTimeout(r, 10));
  const edits = [];
  const volume = state.show.findIndex((s) => s.kind === "volume");
  for (let i = 0; i < 30; ++i) {
    const set = volume >= 0 ? { opacity: `0:0,${0.3 + 0.01 * i}:0.2,1:0.6` } : { range: `0,${1 + i / 30}` };
    const begin = performance.now(), before = state.revision;
    socket.send(JSON.stringify({ do: "edit", n: ++n, live: true, edits: [{ at: `show/${Math.max(0, volume)}`, set }] }));
    await until((f) => f.revision > before);
    edits.push(performance.now() - begin);
    await new Promise((r) => setTimeout(r, 100));
  }
  const exactly = performance.now();
  draw({ camera: turned(0), moving: false });
  const exact = await Promise.race([until((f) => f.n === n && f.final), new Promise((r) => setTimeout(r, 120000, null))]);
  return {
    drag: [median(drags), median(drags, 0.95)],
    coarse: median(coarse),
    edit: [median(edits), median(edits, 0.95)],
    all,
    exact: exact ? performance.now() - exactly : Infinity,
  };
};
const before = memory();
const curve = []; // of frames and of what the server then has
await page.exposeFunction("noteMemory", (frame) => void curve.push([frame, memory()]));
const r = await page.evaluate(client, { size, frames });
const after = memory();
const ms = (v) => `${v.toFixed(0)} ms`;
const mib = (v) => `${v.toFixed(1)} MiB`;
const settled = curve.find(([frame]) => frame >= 2000), last = curve[curve.length - 1];
const growth = settled && settled[0] < last[0] ? `\n  grown from frame ${settled[0]} to ${last[0]}`.padEnd(43) + mib(last[1] - settled[1]) : "";
console.log(`${words[0].split("/").pop()}, ${size.join("x")}, ${frames} frames
first picture, from the program's start   ${ms(first)}
${parts.map(([words, at]) => `  ${words.padEnd(40)}${Number.isFinite(at) ? ms(at) : "later"}`).join("\n")}
drag to picture, median and 95 %          ${ms(r.drag[0])}, ${ms(r.drag[1])} (one sample for ${r.coarse} x ${r.coarse} pixels)
edit to picture, median and 95 %          ${ms(r.edit[0])}, ${ms(r.edit[1])}
rest to all pixels, and to the exact one  ${ms(r.all)}, ${ms(r.exact)}
memory of the server, at the beginning    ${mib(before)}
${curve.map(([frame, v]) => `  after ${`${frame} frames`.padEnd(34)}${mib(v)}`).join("\n")}${growth}
  after 30 edits and an exact picture     ${mib(after)}`);
await browser.close();
server.kill("SIGINT");
