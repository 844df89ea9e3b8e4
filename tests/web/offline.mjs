// SPDX-License-Identifier: Apache-2.0
// Offline pages in a browser without a graphics card: that they ask no network for anything, look as the PNG of the same words does, turn,
// take another opacity, and can be used by everybody. Usage: node tests/web/offline.mjs PROGRAM [DATA]. Without a browser or
// playwright-core all is skipped, and says so. Times are printed and never judged: they are those of this machine.
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.argv[2] ?? join(here, "../../build/sightglass"), data = process.argv[3] ?? process.env.SIGHTGLASS_DATA ?? "";
const only = process.env.ONLY ?? "", keep = process.env.KEEP ?? "";
const browserPath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((p) => existsSync(p));

/** Picture, its words, and what it may differ by: mean of all channels, the 99 % difference, of 255. */
const scenes = [
  { name: "surface of one colour", words: ["-s", "sphere"] },
  { name: "surface coloured by points", words: ["-s", "gyroid size=48", "-f", "contour", "--show", "surface field=Normals component=0"] },
  { name: "volume", words: ["-s", "gyroid size=48", "--show", "volume opacity=0:0,0.6:0,1:0.3"], volume: true },
  { name: "maximum of a volume", words: ["-s", "gyroid size=48", "--show", "volume mode=maximum"], volume: true },
  { name: "plane field", words: ["-s", "double_gyre dims=81,41,1", "--show", "surface field=velocity"] },
  { name: "glyphs", words: ["-s", "abc dims=5,5,5", "--show", "glyphs shape=sphere size=1"] },
  { name: "thick lines", words: ["-s", "abc dims=12,12,12", "-f", "streamlines count=12", "--show", "lines width=12 color=steelblue"] },
  { name: "points as spheres", words: ["-s", "gyroid size=6", "--show", "points size=24"] },
  { name: "seen through", words: ["-s", "sphere", "--show", "surface opacity=0.4"] },
  { name: "isosurface by rays", words: ["-s", "gyroid size=32", "--show", "volume mode=isosurface levels=0"], volume: true },
];

const failures = [];
let checks = 0, skipped = 0;
function check(good, what) {
  ++checks;
  if (!good) failures.push(what), console.log(`FAILED: ${what}`);
}
function skip(why) {
  ++skipped;
  console.log(`SKIPPED: ${why}`);
}

let chromium, AxeBuilder;
try {
  const required = createRequire(join(here, "../../web/package.json"));
  ({ chromium } = required("playwright-core"));
  ({ AxeBuilder } = required("@axe-core/playwright"));
} catch {
  skip("playwright-core is not installed (npm ci in web/)");
}
if (chromium && !browserPath) skip("no chromium is installed");
if (!chromium || !browserPath) end();

const folder = keep || mkdtempSync(join(tmpdir(), "sightglass-page-"));
const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });

async function open(file, options = {}) {
  const page = await browser.newPage({ viewport: { width: 640, height: 400 }, ...options });
  const requests = [], errors = [];
  page.on("request", (r) => requests.push(r.url().slice(0, 100)));
  page.on("pageerror", (e) => errors.push(e.message));
  // Reading back a pixel is how the page waits for what it drew; a driver's remark about its speed is no error.
  page.on("console", (m) => { if ((m.type() === "error" || m.type() === "warning") && !m.text().includes("OpenGL, Performance")) errors.push(m.text()); });
  const start = Date.now();
  await page.goto("file://" + file);
  await page.waitForFunction(() => window.sightglass || document.documentElement.dataset.state, null, { timeout: 120000 });
  const opened = Date.now() - start;
  await page.waitForFunction(() => document.documentElement.dataset.state, null, { timeout: 300000 });
  return { page, requests, errors, opened, still: Date.now() - start };
}

/** Means, and the difference that 99 % of the pixels do not exceed, over what is drawn in both pictures; edges apart from the rest. */
function compare(page, pngFile) {
  return page.evaluate(async ({ png }) => {
    const v = window.sightglass.viewer;
    const image = new Image();
    image.src = png;
    await image.decode();
    const canvas = document.createElement("canvas"), c = canvas.getContext("2d", { willReadFrequently: true });
    canvas.width = image.width, canvas.height = image.height;
    c.drawImage(image, 0, 0);
    const a = c.getImageData(0, 0, image.width, image.height).data, w = image.width, h = image.height;
    const shot = v.snapshot();
    if (shot.width !== w || shot.height !== h) return { size: [shot.width, shot.height] };
    const b = shot.getContext("2d").getImageData(0, 0, w, h).data;
    const largest = (p) => Math.max(Math.abs(a[p] - b[p]), Math.abs(a[p + 1] - b[p + 1]), Math.abs(a[p + 2] - b[p + 2]));
    // A place is an edge where the PNG changes much from one pixel to the next.
    const steep = (x, y) => {
      for (let dy = -1; dy <= 1; ++dy) for (let dx = -1; dx <= 1; ++dx) {
        const p = 4 * (y * w + x), q = 4 * ((y + dy) * w + x + dx);
        for (let k = 0; k < 3; ++k) if (Math.abs(a[p + k] - a[q + k]) > 24) return true;
      }
      return false;
    };
    const area = v.layout.area, inside = [], edges = [];
    for (let y = Math.max(1, area.y); y < Math.min(h - 1, area.y + area.height); ++y)
      for (let x = Math.max(1, area.x); x < Math.min(w - 1, area.x + area.width); ++x) {
        const p = 4 * (y * w + x), back = a[p] > 252 && a[p + 1] > 252 && a[p + 2] > 252 && b[p] > 252 && b[p + 1] > 252 && b[p + 2] > 252;
        if (back) continue;
        (steep(x, y) ? edges : inside).push(largest(p));
      }
    const mean = (l) => l.reduce((s, x) => s + x, 0) / Math.max(1, l.length), at = (l, q) => [...l].sort((x, y) => x - y)[Math.min(l.length - 1, Math.floor(q * l.length))] ?? 0;
    let bar = 0, bars = 0;
    for (const l of v.step.annotation.legends) {
      if (!l.colors) continue;
      ++bars;
      const [bx, by, bw, bh] = l.bar.map(Math.round);
      for (let y = by; y < by + bh; ++y) for (let x = bx; x < bx + bw; ++x) bar = Math.max(bar, largest(4 * (y * w + x)));
    }
    return { pixels: inside.length, mean: mean(inside), most99: at(inside, 0.99), edge: mean(edges), bar: bars ? bar : null };
  }, { png: "data:image/png;base64," + readFileSync(pngFile).toString("base64") });
}

/** Contrast, as WCAG 2 has it, of a grey of so much opacity on white. */
function contrastOnWhite(grey, opacity) {
  const seen = (255 - opacity * (255 - grey)) / 255;
  return 1.05 / (((seen + 0.055) / 1.055) ** 2.4 + 0.05);
}

function render(words, output) {
  try {
    execFileSync(program, ["render", ...words, "--size", "640x400", "-q", "-o", output], { stdio: ["ignore", "ignore", "pipe"] });
    return "";
  } catch (e) {
    return String(e.stderr ?? e);
  }
}

for (const s of scenes) {
  if (only && !s.name.includes(only)) continue;
  const html = join(folder, s.name.replaceAll(" ", "_") + ".html"), png = html.replace(".html", ".png");
  const trouble = render(s.words, html) || render(s.words, png);
  if (trouble) {
    check(false, `${s.name}: ${trouble}`);
    continue;
  }
  const { page, requests, errors, opened, still } = await open(html);
  check(requests.filter((r) => !r.startsWith("file:") && !r.startsWith("data:")).length === 0 && requests.filter((r) => r.startsWith("file:")).length === 1, `${s.name}: no request but the page itself, had ${requests}`);
  check(errors.length === 0, `${s.name}: no errors, had ${errors.slice(0, 3).join("; ")}`);
  check((await page.evaluate(() => document.documentElement.dataset.state)) === "still", `${s.name}: the scene is drawn`);
  const d = await compare(page, png);
  check(d.mean < 2 && d.most99 <= 6, `${s.name}: as the PNG`);
  if (d.bar !== null) check(d.bar <= 1, `${s.name}: the legend's bar has the PNG's colours`);
  const turned = await page.evaluate(async () => {
    const v = window.sightglass.viewer, before = v.snapshot().toDataURL();
    let frames = 0;
    const start = performance.now();
    while (performance.now() - start < 2000) {
      v.camera.turn(0.05, 0.02), v.draw(true);
      await new Promise(requestAnimationFrame);
      ++frames;
    }
    while (!v.still) await new Promise((r) => setTimeout(r, 50));
    return { frames: frames / 2, changed: v.snapshot().toDataURL() !== before };
  });
  check(turned.changed, `${s.name}: it turns`);
  if (s.volume && s.name === "volume") {
    const edited = await page.evaluate(async () => {
      const { viewer: v, editor } = window.sightglass, before = v.snapshot().toDataURL();
      v.setOpacity(editor.points.map(([x, o]) => [x, Math.min(1, 3 * o)]));
      while (!v.still) await new Promise((r) => setTimeout(r, 50));
      return { changed: v.snapshot().toDataURL() !== before };
    });
    check(edited.changed, `${s.name}: another opacity is seen`);
  }
  console.log(`${s.name}: ${(statSync(html).size / 1024).toFixed(0)} KiB, mean ${d.mean?.toFixed(2)}, 99 % ${d.most99}, edges ${d.edge?.toFixed(1)}, bar ${d.bar ?? "-"} (of 255, ${d.pixels} pixels); opens in ${opened} ms, still after ${still} ms, turns at ${turned.frames.toFixed(1)} frames/s`);
  if (keep) await page.screenshot({ path: html.replace(".html", ".shot.png") });
  await page.close();
}
// Everybody can use it: in both colours of screens, wide and as narrow as a phone, with what each kind of page has beside the picture.
if (!only || only === "accessible") {
  const pages = {
    surface: ["-s", "gyroid size=24", "-f", "contour", "--show", "surface field=Normals component=0"],
    volume: ["-s", "gyroid size=24", "--show", "volume opacity=0:0,0.6:0,1:0.3"],
    times: ["-s", "double_gyre dims=41,21,1", "--show", "surface field=velocity", "--times", "0,0.3,0.6"],
  };
  for (const [name, words] of Object.entries(pages)) {
    const html = join(folder, `accessible_${name}.html`);
    const trouble = render(words, html);
    check(!trouble, `accessible ${name}: ${trouble}`);
    if (trouble) continue;
    for (const [colorScheme, viewport] of [["light", { width: 640, height: 400 }], ["dark", { width: 640, height: 400 }], ["light", { width: 390, height: 700 }]]) {
      const context = await browser.newContext({ colorScheme, viewport });
      const page = await context.newPage();
      await page.goto("file://" + html);
      await page.waitForFunction(() => document.documentElement.dataset.state === "still", null, { timeout: 300000 });
      // Over a canvas axe cannot say: dark words on white, as far as the bar lets the picture through.
      const through = await page.evaluate(() => Number(getComputedStyle(document.querySelector(".bar")).opacity));
      check(contrastOnWhite(0x17, through) >= 4.5, `accessible ${name}: words of the bar stand out by ${contrastOnWhite(0x17, through).toFixed(1)}`);
      for (const opens of ["opacity", "about"]) {
        const control = page.locator(".bar").getByText(opens, { exact: true });
        if (await control.count()) await control.click();
      }
      const { violations } = await new AxeBuilder({ page }).analyze();
      for (const v of violations.filter((v) => v.impact === "serious" || v.impact === "critical"))
        check(false, `accessible ${name}, ${colorScheme}, ${viewport.width} wide: ${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 140)).join(" | ")}`);
      const outside = await page.evaluate(() => [...document.querySelectorAll("button, input, select, summary")].filter((e) => e.checkVisibility()).filter((e) => {
        const b = e.getBoundingClientRect();
        return b.left < 0 || b.top < 0 || b.right > window.innerWidth || b.bottom > window.innerHeight;
      }).map((e) => e.textContent));
      check(outside.length === 0, `accessible ${name}, ${viewport.width} wide: within the page, not so ${outside}`);
      if (keep) await page.screenshot({ path: join(folder, `accessible_${name}_${colorScheme}_${viewport.width}.png`) });
      await context.close();
    }
  }
}
if (!only) {
  // Time steps: another one is another picture, and the slider tells of it.
  const series = join(folder, "series.html");
  const trouble = render(["-s", "double_gyre dims=41,21,1", "--show", "surface field=velocity", "--times", "0,0.3,0.6"], series);
  check(!trouble, `series: ${trouble}`);
  if (!trouble) {
    const { page, errors } = await open(series);
    const seen = await page.evaluate(async () => {
      const v = window.sightglass.viewer, before = v.snapshot().toDataURL();
      await v.show(2);
      while (!v.still) await new Promise((r) => setTimeout(r, 20));
      return { changed: v.snapshot().toDataURL() !== before, told: document.querySelector(".time").textContent, at: document.querySelector(".times input").value };
    });
    check(seen.changed && seen.told.startsWith("3 of 3, t = 0.6") && seen.at === "2", `series: the third step is seen and told, had ${JSON.stringify(seen)}`);
    check(errors.length === 0, `series: no errors, had ${errors.slice(0, 3).join("; ")}`);
    await page.close();
  }
  // Mouse and keys.
  const ball = join(folder, "ball.html");
  check(!render(["-s", "sphere"], ball), "ball");
  const { page } = await open(ball);
  const camera = () => page.evaluate(() => JSON.stringify(window.sightglass.viewer.camera));
  const moved = async (what, act) => {
    const before = await camera();
    await act();
    check((await camera()) !== before, `controls: ${what}`);
  };
  await page.mouse.move(300, 200);
  await moved("a drag turns", async () => { await page.mouse.down(), await page.mouse.move(340, 230), await page.mouse.up(); });
  await moved("the wheel zooms", () => page.mouse.wheel(0, 200));
  await moved("a key turns", () => page.keyboard.press("ArrowLeft"));
  await moved("a button shows another side", () => page.getByRole("button", { name: /View: top/ }).click());
  await moved("a button changes the projection", () => page.getByRole("button", { name: /projection/ }).click());
  await page.close();
  // Without WebGL2 the page has its picture, and says why it does not turn.
  const plain = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"] });
  const still = await plain.newPage({ viewport: { width: 640, height: 400 } });
  await still.goto("file://" + ball);
  await still.waitForFunction(() => document.documentElement.dataset.state, null, { timeout: 60000 });
  const shown = await still.evaluate(() => ({ state: document.documentElement.dataset.state, text: document.querySelector(".sentence")?.textContent, width: document.getElementById("poster")?.naturalWidth }));
  check(shown.state === "picture" && /no WebGL2/.test(shown.text) && shown.width > 100, `without WebGL2: ${JSON.stringify(shown)}`);
  await plain.close();
}
await browser.close();
if (!keep) rmSync(folder, { recursive: true, force: true });
end();

function end() {
  console.log(`web/offline: ${checks} checks, ${failures.length} failed, ${skipped} skipped`);
  process.exit(failures.length ? 1 : 0);
}
