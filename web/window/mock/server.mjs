// SPDX-License-Identifier: Apache-2.0
// node window/mock/server.mjs [--program SIGHTGLASS] [--port 8765] FILE
import { execFile, execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { mkdtempSync, readFileSync, existsSync, rmSync } from "node:fs";
import { basename, extname, join, resolve } from "node:path";
import { tmpdir } from "node:os";
import { WebSocketServer } from "ws";
import { describe } from "./data.mjs";
import { Pipeline } from "./session.mjs";
import { answer } from "./answers.mjs";

const option = (name, otherwise) => {
  const i = process.argv.indexOf(`--${name}`);
  return i > 0 ? process.argv.splice(i, 2)[1] : otherwise;
};
const program = option("program", "sightglass");
const port = Number(option("port", "8765"));
const file = process.argv[2];
const dist = resolve(import.meta.dirname, "../../dist/window");
const scratch = mkdtempSync(join(tmpdir(), "sightglass-mock-"));
process.on("exit", () => rmSync(scratch, { recursive: true, force: true }));
process.on("SIGTERM", () => process.exit(0));
process.on("SIGINT", () => process.exit(0));

const catalog = execFileSync(program, ["ops", "--json"], { maxBuffer: 1 << 26 });
const pipeline = new Pipeline(file, basename(file), describe(program, file));
const saved = new Map();
const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const policy =
  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const server = createServer((request, response) => {
  const path = new URL(request.url, "http://x").pathname;
  const send = (code, type, body) => {
    response.writeHead(code, { "Content-Type": type, "Content-Security-Policy": policy, "X-Content-Type-Options": "nosniff", "Cache-Control": "no-cache" });
    response.end(body);
  };
  if (path === "/catalog.json") return send(200, "application/json", catalog);
  if (saved.has(path)) return send(200, "image/png", saved.get(path));
  const at = join(dist, path === "/" ? "index.html" : path);
  if (!at.startsWith(dist) || !existsSync(at)) return send(404, "text/plain", "not found");
  send(200, types[extname(at)] ?? "application/octet-stream", readFileSync(at));
});

const sockets = new WebSocketServer({ server, path: "/socket", maxPayload: 256 * 1024 });
const clients = new Map();
let ids = 0;

const text = (socket, message) => socket.readyState === 1 && socket.send(JSON.stringify(message));
const everyone = (message) => [...clients.keys()].forEach((s) => text(s, typeof message === "function" ? message(s) : message));
const tellPeople = () =>
  everyone((s) => ({ is: "people", count: clients.size, cursors: [...clients].filter(([o, c]) => o !== s && c.cursor).map(([, c]) => ({ id: c.id, ...c.cursor })) }));

sockets.on("connection", (socket, request) => {
  const client = { id: ++ids, views: new Map(), cursor: null };
  clients.set(socket, client);
  text(socket, pipeline.state(0));
  tellPeople();
  socket.on("message", (data) => receive(socket, client, JSON.parse(data)));
  const first = new URL(request.url, "http://x").searchParams.get("say");
  if (first) void receive(socket, client, JSON.parse(first));
  socket.on("close", () => {
    for (const v of client.views.values()) v.process?.kill();
    clients.delete(socket);
    tellPeople();
  });
});

function stateToAll(socket, n) {
  everyone((s) => pipeline.state(s === socket ? n : 0));
  for (const [s, c] of clients) for (const [view, v] of c.views) if (v.draw) draw(s, c, { ...v.draw, view });
}

async function receive(socket, client, m) {
  const refuse = (errors) => text(socket, { is: "refused", n: m.n, errors });
  switch (m.do) {
    case "edit": {
      const errors = pipeline.edit(m.edits, m.live);
      return errors.length > 0 ? refuse(errors) : stateToAll(socket, m.n);
    }
    case "undo":
      pipeline.undo();
      return stateToAll(socket, m.n);
    case "redo":
      pipeline.redo();
      return stateToAll(socket, m.n);
    case "time":
      pipeline.time = m.time;
      pipeline.revision++;
      return stateToAll(socket, m.n);
    case "draw":
      return draw(socket, client, m);
    case "shown": {
      const v = client.views.get(m.view);
      if (v) {
        v.waits = false;
        v.next?.();
      }
      return;
    }
    case "cursor":
      client.cursor = { view: m.view, at: m.at, camera: m.camera };
      return tellPeople();
    case "save": {
      const picture = await render(m.camera, m.size, { process: null }).catch(() => null);
      if (!picture) return refuse([{ at: "", word: "", text: "the picture could not be drawn" }]);
      saved.set(`/saved/${m.n}`, picture);
      return text(socket, { is: "saved", n: m.n, url: `/saved/${m.n}`, name: `${basename(file).split(".")[0]}.png` });
    }
    default: {
      const a = answer(m, pipeline);
      return a ? text(socket, { n: m.n, ...a }) : refuse([{ at: "", word: "", text: `'${m.do}' is not known` }]);
    }
  }
}

/** First a small picture, then, if the camera rests, the whole one: one frame of a view is under way at a time. */
async function draw(socket, client, m) {
  const v = client.views.get(m.view) ?? {};
  client.views.set(m.view, v);
  v.draw = m;
  const job = (v.job = Symbol());
  v.process?.kill();
  const sizes = m.moving ? [3] : [4, 1];
  for (const coarse of sizes) {
    const began = Date.now();
    const revision = pipeline.revision;
    const size = m.size.map((s) => Math.max(8, Math.round(s / coarse)));
    const picture = await render(m.camera, size, v, coarse > 1).catch(() => null);
    if (v.job !== job || !picture) return;
    while (v.waits) {
      await new Promise((go) => (v.next = go));
      if (v.job !== job) return;
    }
    v.waits = true;
    const header = { is: "frame", n: m.n, view: m.view, revision, type: "image/png", size, of: m.size, coarse, final: coarse === 1, area: [0, 0, Math.round(m.size[0] * 0.8), m.size[1]], camera: m.camera ?? pipeline.info.camera, milliseconds: Date.now() - began };
    const head = Buffer.from(JSON.stringify(header));
    const length = Buffer.alloc(4);
    length.writeUInt32LE(head.length);
    socket.send(Buffer.concat([length, head, picture]));
  }
}

let pictures = 0;
function render(camera, size, job) {
  const c = camera ?? pipeline.info.camera;
  const out = join(scratch, `${++pictures}.png`);
  let position = c.position;
  if (c.parallel) {
    const back = c.position.map((p, i) => p - c.target[i]);
    const distance = c.height / 2 / Math.tan((c.view_angle * Math.PI) / 360);
    position = back.map((b, i) => c.target[i] + (b / Math.hypot(...back)) * distance);
  }
  const list = (v) => v.map((x) => Number(x.toPrecision(9))).join(",");
  const view = `position=${list(position)} target=${list(c.target)} up=${list(c.up)} view_angle=${c.view_angle} projection=${c.parallel ? "parallel" : "perspective"}`;
  const args = [...pipeline.command(), "--read-anywhere", "--quiet", "--camera", view, "--size", size.join("x"), "-o", out];
  return new Promise((resolve, reject) => {
    job.process = execFile(program, args, { timeout: 60000 }, (error, _, stderr) => {
      if (error) {
        if (!error.killed && !error.signal) everyone({ is: "note", text: stderr.trim().split("\n").pop() || error.message });
        return reject(error);
      }
      const bytes = readFileSync(out);
      rmSync(out);
      resolve(bytes);
    });
  });
}

server.listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${port}/`));
