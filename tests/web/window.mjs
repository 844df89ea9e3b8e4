// SPDX-License-Identifier: Apache-2.0
// node tests/web/window.mjs [--mock]: see README.md
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { basename, dirname } from "node:path";
import { gzipSync } from "node:zlib";
import { accessibility, phone } from "./access.mjs";
import { measuring, overTime } from "./measuring.mjs";
import { scene } from "./scene.mjs";
import { views } from "./views.mjs";
import { wiring } from "./wiring.mjs";
import { andSettle, cleanUp, dataFile, dragOn, launch, middleOf, openPage, options, seen, serve, seriesFile, settled, shot } from "./browser.mjs";

const o = options();
const browser = await launch();
let failures = 0;
let passed = 0;

async function test(name, run) {
  if (o.only && !name.includes(o.only)) return;
  const began = Date.now();
  try {
    await run();
    passed++;
    console.log(`ok   ${name} (${Date.now() - began} ms)`);
  } catch (error) {
    failures++;
    console.log(`FAIL ${name}: ${error.stack?.split("\n").slice(0, 6).join("\n     ")}`);
    await shot(o, page, `failed_${name.slice(0, 20).replaceAll(" ", "_")}`).catch(() => undefined);
  }
}

const server = await serve(o, dataFile(o));
let bytes = 0;
const first = await browser.newContext();
await first.close();
let page = await openPage(browser, server.url);
const address = page.url(); // without the token, which counts once
const picture = page.locator(".view-surface").first();
const middle = await middleOf(picture);
const tab = (name) => page.click(`#tab-${name}`);
/** How many there are, once there is one: panels are drawn a moment after what they show has changed. */
const countOf = async (selector) => {
  await page.locator(selector).first().waitFor();
  return page.locator(selector).count();
};
/** Opens the search for operations and types, until that one stands first. */
const found = async (words, operation) => {
  await page.keyboard.press("a");
  await page.locator("dialog[open] input").first().fill(words);
  await page.waitForFunction((name) => document.querySelector(".add-list li")?.textContent.includes(name), operation);
};
/** Waits until there are so many. */
const become = async (selector, wanted, why = selector) => {
  const until = Date.now() + 10000;
  while ((await page.locator(selector).count()) !== wanted && Date.now() < until) await page.waitForTimeout(50);
  assert.equal(await page.locator(selector).count(), wanted, why);
};

await test("the first picture comes by itself, final and not empty", async () => {
  assert.ok((await seen(page)).colors > 10);
  assert.match(await page.title(), /Sightglass/);
  await shot(o, page, "first");
});

await test("the page weighs less than 250 kB, and all of it is the server's", async () => {
  const other = await page.context().newPage();
  const bodies = [];
  other.on("response", (r) => {
    if (/^(blob|data):/.test(r.url())) return;
    assert.ok(r.url().startsWith(new URL(address).origin), r.url());
    if (r.ok() && !/catalog/.test(r.url())) bodies.push(r.body());
  });
  await other.goto(address);
  await settled(other);
  for (const body of await Promise.all(bodies)) bytes += gzipSync(body).length;
  await other.close();
  assert.ok(bytes > 10000 && bytes < 250000, `${bytes} bytes`);
});

await test("dragging turns, and leaves the final picture of where it ended", async () => {
  const before = await seen(page);
  await andSettle(page, () => dragOn(page, middle, [140, 60]));
  const after = await seen(page);
  assert.notEqual(after.sum, before.sum);
  await page.waitForTimeout(400);
  assert.equal((await seen(page)).sum, after.sum, "the picture at rest does not change");
});

await test("keys turn, move, zoom and look along axes; the same view is the same picture", async () => {
  await picture.focus();
  const pictures = [];
  for (const key of ["1", "ArrowLeft", "Shift+ArrowUp", "+", "]", "p", "1"]) {
    await andSettle(page, () => page.keyboard.press(key));
    pictures.push((await seen(page)).sum);
  }
  assert.equal(new Set(pictures.slice(0, 6)).size, 6, "each key changes the picture");
  await andSettle(page, () => page.keyboard.press("p"));
  await andSettle(page, () => page.keyboard.press("1"));
  assert.equal((await seen(page)).sum, pictures[0], "back to the first");
  await andSettle(page, () => page.keyboard.press("r"));
});

await test("wheel and pinch zoom", async () => {
  const before = await seen(page);
  await andSettle(page, async () => {
    await page.mouse.move(...middle);
    await page.mouse.wheel(0, -300);
  });
  assert.notEqual((await seen(page)).sum, before.sum);
  await andSettle(page, () => page.keyboard.press("r"));
  assert.equal((await seen(page)).sum, before.sum);
});

await test("resting on the picture tells the value, a click keeps it and marks it in the curve", async () => {
  await page.mouse.move(middle[0] - 60, middle[1] - 10);
  await page.mouse.move(middle[0] - 61, middle[1] - 10);
  await page.waitForFunction(() => /·/.test(document.querySelector(".probe").textContent), null, { timeout: 10000 });
  await page.mouse.click(middle[0] - 61, middle[1] - 10);
  await page.waitForSelector(".pin", { state: "attached" });
  await tab("color");
  await page.waitForSelector(".marked", { state: "attached" });
  await shot(o, page, "curve");
});

await test("a point of the opacity curve is dragged, and the words of the command line follow", async () => {
  await tab("color");
  const text = () => page.locator("[aria-label=\"The command line's words\"]").textContent();
  const before = [await text(), (await seen(page)).sum];
  const point = page.locator(".point").nth(1);
  await andSettle(page, async () => dragOn(page, await middleOf(point), [30, -30]));
  assert.notEqual(await text(), before[0]);
  assert.match(await text(), /opacity=@/);
  assert.notEqual((await seen(page)).sum, before[1]);
  await andSettle(page, () => page.click("button[aria-label=Undo]"));
  assert.equal((await seen(page)).sum, before[1], "one step back undoes the whole drag");
  await andSettle(page, () => page.click("button[aria-label=Redo]"));
  assert.notEqual((await seen(page)).sum, before[1]);
});

await test("points are added, typed and taken away", async () => {
  await tab("color");
  const before = await countOf(".point");
  await andSettle(page, () => page.click("text=/\\+ point/"));
  await become(".point", before + 1);
  await page.locator(".point").nth(1).focus();
  await andSettle(page, () => page.keyboard.press("Delete"));
  await become(".point", before);
  await page.click("text=points as numbers");
  const box = page.getByLabel("Opacity of point 2", { exact: true });
  await andSettle(page, async () => {
    await box.fill("0.37");
    await box.press("Enter");
  });
  assert.match(await page.locator("[aria-label=\"The command line's words\"]").textContent(), /:0\.37/);
});

await test("another colour map and a proposal change the picture, with their reason", async () => {
  await tab("color");
  const before = (await seen(page)).sum;
  await page.click("text=Choose …");
  await andSettle(page, () => page.click("button.map:has-text('ember')"));
  const ember = (await seen(page)).sum;
  assert.notEqual(ember, before);
  await page.click("text=Choose …");
  await page.click("text=Propose");
  await page.waitForSelector(".proposal");
  assert.ok((await page.locator(".proposal").first().textContent()).length > 10);
  await andSettle(page, () => page.locator(".proposal").last().click());
});

await test("widgets over value and gradient are drawn, moved and undone", async () => {
  await tab("color");
  await page.locator("section:has(h2:text('Value and gradient')) button").first().click();
  await andSettle(page, () => page.click("text=+ rectangle"));
  const text = () => page.locator("[aria-label=\"The command line's words\"]").textContent();
  assert.match(await text(), /widgets=.*rectangle/);
  const before = await text();
  await andSettle(page, async () => dragOn(page, await middleOf(page.locator(".widget path").first()), [25, -20]));
  assert.notEqual(await text(), before);
  await shot(o, page, "widgets");
  await andSettle(page, () => page.click("text=Remove all"));
});

await test("the place that was clicked is marked over value and gradient, too", async () => {
  await page.mouse.click(middle[0] - 61, middle[1] - 10);
  await tab("color");
  const opens = page.locator("section:has(h2:text('Value and gradient')) button").first();
  if ((await opens.getAttribute("aria-expanded")) !== "true") await opens.click();
  const mark = page.locator(".plane .marked");
  await mark.locator("circle").waitFor({ state: "attached" });
  assert.equal(await mark.locator("circle").getAttribute("cx"), await mark.locator("line").getAttribute("x1"));
  await mark.scrollIntoViewIfNeeded();
  await shot(o, page, "plane_mark");
});

await test("an ellipse is drawn and moved by keys, strokes are painted by pointer and keys, each one step of undo", async () => {
  await tab("color");
  const words = async () => (await page.locator("[aria-label=\"The command line's words\"]").textContent()) ?? "";
  const until = async (pattern, why) => {
    for (let i = 0; i < 100 && !pattern.test(await words()); i++) await page.waitForTimeout(50);
    assert.match(await words(), pattern, why);
  };
  const opens = page.locator("section:has(h2:text('Value and gradient')) button").first();
  if ((await opens.getAttribute("aria-expanded")) !== "true") await opens.click();
  await andSettle(page, () => page.click("text=+ ellipse"));
  await until(/widgets=.*ellipse @/);
  const shape = page.locator(".widget path").first();
  await shape.focus();
  const before = await words();
  await andSettle(page, () => page.keyboard.press("ArrowRight"));
  await andSettle(page, () => page.keyboard.press("Shift+ArrowUp"));
  assert.notEqual(await words(), before);
  const ellipse = await words();
  await andSettle(page, async () => dragOn(page, await middleOf(page.locator(".grip").nth(1)), [20, 0]));
  assert.notEqual(await words(), ellipse, "a handle makes it wider");

  await page.click("button:text-is('paint')");
  const area = page.locator(".paint-area");
  const box = await area.boundingBox();
  const from = [box.x + 0.15 * box.width, box.y + 0.8 * box.height];
  await andSettle(page, async () => dragOn(page, from, [0.3 * box.width, -0.4 * box.height]));
  await until(/widgets=.*ellipse .*; paint @[-.\d]+:[.\d]+ (@[-.\de]+,[.\de]+ ){2,}0\.6/, "a stroke");
  await andSettle(page, () => page.mouse.click(box.x + 0.8 * box.width, box.y + 0.5 * box.height));
  await until(/paint .*paint @\S+ @\S+ 0\.6/, "a dab");
  await area.focus();
  const dabbed = await words();
  await page.keyboard.down("Shift");
  for (const key of ["ArrowLeft", "ArrowLeft", "ArrowUp", "ArrowUp"]) await page.keyboard.press(key);
  await andSettle(page, () => page.keyboard.up("Shift"));
  await until(/paint .*paint .*paint /, "a stroke by keys");
  const painted = await words();
  await shot(o, page, "painted");
  await andSettle(page, () => page.click("button[aria-label=Undo]"));
  for (let i = 0; i < 100 && (await words()) !== dabbed; i++) await page.waitForTimeout(50);
  assert.equal(await words(), dabbed, "a stroke by keys is one step");
  await andSettle(page, () => page.click("button[aria-label=Redo]"));
  for (let i = 0; i < 100 && (await words()) !== painted; i++) await page.waitForTimeout(50);
  assert.equal(await words(), painted);
  for (let i = 0; i < 3; i++) await andSettle(page, () => page.click("button[aria-label=Undo]"));
  assert.ok(!/paint /.test(await words()), "a stroke is one step");
  await until(/widgets=.*ellipse/);
  await page.click("button:text-is('paint')");
  await andSettle(page, () => page.click("text=Remove all"));
});

await test("a contour is added by search, its value dragged, and a mistake stands at its control", async () => {
  await picture.focus();
  await found("isosurf", "contour");
  await shot(o, page, "add");
  await andSettle(page, () => page.keyboard.press("Enter"));
  await page.waitForSelector("[data-word=values]");
  await become("[data-word=values]", 1);
  const before = (await seen(page)).sum;
  const slider = page.locator("[data-word=values] input[type=range]").first();
  if (await slider.count()) {
    await andSettle(page, async () => {
      await slider.focus();
      for (let i = 0; i < 60; i++) await page.keyboard.press("ArrowLeft");
    });
    assert.notEqual((await seen(page)).sum, before);
  }
  const box = page.locator("[data-word=values] input[type=text]");
  await box.fill("abc");
  await box.press("Enter");
  await page.waitForSelector("[data-word=values] .problem");
  assert.equal(await box.inputValue(), "abc", "what was typed stays");
  assert.equal(await box.getAttribute("aria-invalid"), "true");
  await shot(o, page, "mistake");
  await box.fill("");
  await box.press("Enter");
  await page.waitForSelector("[data-word=values] .problem", { state: "detached" });
  await settled(page);
});

await test("the pipeline forks in the graph, steps tell their bytes and times", async () => {
  await tab("steps");
  const steps = await countOf(".item");
  await page.locator(".item-name").first().click();
  await found("slice", "slice");
  await andSettle(page, () => page.keyboard.press("Enter"));
  await page.locator(".segmented >> text=graph").click();
  await become(".node", steps + 1);
  await become(".edge", steps, "each step but the first takes from it");
  await shot(o, page, "graph");
  await page.locator(".segmented >> text=list").click();
  assert.match(await page.locator(".numbers").first().textContent(), /(s|–).*B/);
});

await test("a plane is dragged in the picture", async () => {
  const handle = page.locator("[data-handle][aria-label^='Plane of']").first();
  await handle.waitFor();
  const value = await handle.getAttribute("aria-valuetext");
  await handle.focus();
  await andSettle(page, async () => {
    for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowUp");
  });
  assert.notEqual(await page.locator("[data-handle][aria-label^='Plane of']").first().getAttribute("aria-valuetext"), value);
});

await test("the table pages through the numbers of a step", async () => {
  await tab("table");
  await page.waitForSelector(".numbers-table td");
  const rows = await page.locator(".numbers-table tbody tr").count();
  assert.ok(rows > 5);
  await page.click("button[aria-label=On]");
  await page.waitForFunction(() => document.querySelector(".numbers-table tbody th")?.textContent === "50");
  await shot(o, page, "table");
});

await test("values along a line are plotted, and saved as numbers and as a figure", async () => {
  await tab("plot");
  await page.locator(".panel button.primary:has-text('Plot')").click();
  await page.waitForSelector(".uplot canvas");
  await shot(o, page, "plot");
  for (const [button, begins] of [["CSV", "distance"], ["Figure (SVG)", "<svg"]]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(`.panel button:has-text('${button}')`)]);
    assert.ok(readFileSync(await download.path(), "utf8").startsWith(begins));
  }
});

await test("a line is dragged in the picture, and its values are plotted", async () => {
  await picture.focus();
  await page.keyboard.press("l");
  await dragOn(page, [middle[0] - 60, middle[1]], [120, 30]);
  await page.waitForSelector(".panel .uplot canvas");
  // The handles get their places when the overlay is drawn next.
  const placed = await page.waitForFunction(() => {
    const all = [...document.querySelectorAll(".ruler-end")].map((e) => e.getBoundingClientRect());
    return all.length === 2 && all.every((b) => b.x > 0) && all.map((b) => [b.x + b.width / 2, b.y + b.height / 2]);
  });
  const ends = await placed.jsonValue();
  for (const [end, at] of [[ends[0], [middle[0] - 60, middle[1]]], [ends[1], [middle[0] + 60, middle[1] + 30]]])
    assert.ok(Math.hypot(end[0] - at[0], end[1] - at[1]) < 3, `${end} where it was dragged to ${at}`);
  await shot(o, page, "line");
  await page.keyboard.press("t");
});

await test("the window fills the screen and comes back", async () => {
  await andSettle(page, () => page.click("button[aria-label='Full screen']"));
  assert.ok(await page.evaluate(() => document.fullscreenElement === document.documentElement));
  assert.ok((await seen(page)).colors > 10);
  await page.keyboard.press("f");
  await page.waitForFunction(() => document.fullscreenElement === null);
  await settled(page);
});

await test("the session is a file: saved, changed as text, compared, loaded", async () => {
  await tab("file");
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("text=Save …")]);
  const file = await download.path();
  assert.match(readFileSync(file, "utf8"), /^sightglass: /);
  await page.locator(".diff .plus").first().waitFor(); // what changed in this session is listed
  const code = () => page.locator("pre.code").first().textContent();
  const other = (text) => page.waitForFunction((t) => document.querySelector("pre.code")?.textContent !== t, text);
  const before = await code();
  await page.click("button[aria-label=Undo]");
  await other(before);
  const undone = await code();
  await page.setInputFiles("label:has-text('Load …') input", { name: "saved.yaml", mimeType: "application/yaml", buffer: readFileSync(file) });
  await other(undone);
  await settled(page);
  await shot(o, page, "session");
});

await test("a saved picture carries its recipe", async () => {
  await picture.focus();
  await page.keyboard.press("s");
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60000 }), page.click("dialog button.primary")]);
  const png = readFileSync(await download.path());
  assert.equal(png.toString("latin1", 1, 4), "PNG");
  assert.match(png.toString("latin1"), /sightglass/);
});

await test("a picture is saved as what was chosen, and not larger than the server draws", async () => {
  await picture.focus();
  await page.keyboard.press("s");
  const size = page.locator("dialog input.number");
  const typed = [await size.nth(0).inputValue(), await size.nth(1).inputValue()];
  const type = async (texts) => {
    for (const [i, text] of texts.entries()) {
      await size.nth(i).fill(text);
      await size.nth(i).press("Tab");
    }
  };
  await type(["8192", "8192"]);
  await page.waitForSelector("dialog .problem:has-text('16.8 million')");
  assert.ok(await page.locator("dialog button.primary").isDisabled());
  await type(typed);
  for (const [kind, begins] of [["jpg", "\xff\xd8"], ["webp", "RIFF"], ["png", "\x89PNG"]]) {
    if (!(await page.locator("dialog").isVisible())) await page.keyboard.press("s");
    await page.selectOption("dialog select", { label: kind });
    const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60000 }), page.click("dialog button.primary")]);
    assert.ok(download.suggestedFilename().endsWith(`.${kind}`), download.suggestedFilename());
    assert.ok(readFileSync(await download.path()).toString("latin1").startsWith(begins));
    await page.waitForSelector("dialog", { state: "detached" });
    await picture.focus();
  }
});

await test("four views side by side, with linked cameras and a crosshair", async () => {
  await andSettle(page, () => page.click("button[aria-label='Three planes']"));
  await page.waitForFunction(() => document.querySelectorAll(".view").length === 4);
  await settled(page);
  await shot(o, page, "three_planes");
  const before = (await seen(page, 1)).sum;
  const cross = page.locator("[data-handle][aria-label^='Crosshair']").nth(1);
  await andSettle(page, async () => dragOn(page, await middleOf(cross), [30, -25]));
  assert.notEqual((await seen(page, 2)).sum, before, "another view follows");
  await andSettle(page, () => page.click("button[aria-label='One view']"));
});

await test("window and level change the range", async () => {
  await page.click("button[aria-label='Tool: Window and level']");
  const before = (await seen(page)).sum;
  await andSettle(page, () => dragOn(page, middle, [-90, 0]));
  assert.notEqual((await seen(page)).sum, before);
  await page.click("button[aria-label='Tool: Turn']");
});

await test("the legend moves to another side by keys and by dragging", async () => {
  const legend = page.locator(".legend-handle").first();
  await legend.focus();
  await andSettle(page, () => page.keyboard.press("ArrowDown"));
  assert.match(await legend.getAttribute("class"), /bottom/);
  const box = await picture.boundingBox();
  const [x, y] = await middleOf(legend);
  await andSettle(page, () => dragOn(page, [x, y], [box.x + box.width - 12 - x, box.y + box.height / 2 - y]));
  assert.match(await legend.getAttribute("class"), /right/);
});

await test("a second window sees the same session and the cursor of the first", async () => {
  const other = await page.context().newPage();
  await other.goto(address);
  await settled(other);
  await page.waitForSelector(".people");
  for (let i = 0; i < 4; i++) {
    await page.mouse.move(middle[0] + i * 5, middle[1]);
    await page.waitForTimeout(100);
  }
  await other.waitForSelector(".cursor", { state: "attached" });
  const revision = (p) => p.evaluate(() => document.querySelectorAll(".item").length);
  await tab("look");
  await other.click("#tab-look");
  await other.waitForSelector("select[aria-label^='Add a way']");
  const before = await revision(other);
  await page.locator("select[aria-label^='Add a way']").selectOption("outline");
  await other.waitForFunction((n) => document.querySelectorAll(".item").length === n + 1, before);
  await shot(o, other, "second_window");
  await settled(other);
  const own = (await seen(other)).sum;
  await other.locator("select[aria-label='Look along with']").selectOption({ index: 1 });
  await picture.focus();
  await andSettle(page, () => page.keyboard.press("ArrowLeft"));
  await andSettle(other, () => undefined);
  assert.notEqual((await seen(other)).sum, own, "looking along follows the other's camera");
  await other.close();
});

await test("two windows have one view, whichever of them moves it, until one ends that", async () => {
  const other = await page.context().newPage();
  await other.goto(address);
  await settled(other);
  // The same view is the same picture, and not that of before.
  const both = async (why, not) => {
    const until = Date.now() + 25000;
    for (;;) {
      await settled(page);
      await settled(other);
      const [a, b] = [(await seen(page)).sum, (await seen(other)).sum];
      if (a === b && a !== not) return a;
      assert.ok(Date.now() < until, why);
      await page.waitForTimeout(100);
    }
  };
  const apart = async (why) => {
    for (const until = Date.now() + 25000; (await seen(page)).sum === (await seen(other)).sum; await page.waitForTimeout(100)) assert.ok(Date.now() < until, why);
    await settled(page);
  };
  await picture.focus();
  await page.keyboard.press("ArrowUp");
  await apart("each has its own view at first");
  await page.getByLabel("one view for all").check();
  const first = await both("the view of whoever begins");
  await other.waitForFunction(() => document.querySelector(".people input").checked);
  await other.locator(".view-surface").first().focus();
  await other.keyboard.press("ArrowLeft");
  const second = await both("the second one leads", first);
  await page.mouse.move(...middle);
  await page.waitForTimeout(300);
  assert.equal(await both("pointing moves nothing"), second);
  await other.waitForSelector(".cursor", { state: "attached" });
  await picture.focus();
  await page.keyboard.press("Shift+ArrowLeft");
  await both("the first one leads", second);
  await shot(o, page, "one_view");
  await other.getByLabel("one view for all").uncheck();
  await page.waitForFunction(() => !document.querySelector(".people input").checked);
  await page.keyboard.press("ArrowLeft");
  await apart("each has its own view again");
  await other.close();
  await andSettle(page, () => page.keyboard.press("r"));
});

await test("after a reload the session is there again", async () => {
  const steps = await countOf(".item");
  await page.reload();
  await settled(page);
  await page.click("#tab-look");
  await become(".item", steps);
});

await test("a lost connection is said, and comes back by itself", async () => {
  const other = await page.context().newPage();
  const sockets = [];
  await other.routeWebSocket(/socket/, (ws) => {
    sockets.push(ws);
    ws.connectToServer();
  });
  await other.goto(address);
  await settled(other);
  await sockets[0].close();
  await other.waitForSelector(".banner", { timeout: 5000 });
  await other.waitForSelector(".banner", { state: "detached", timeout: 10000 });
  const before = (await seen(other)).sum;
  await other.locator(".view-surface").focus();
  await andSettle(other, () => other.keyboard.press("ArrowLeft"));
  assert.notEqual((await seen(other)).sum, before);
  await other.close();
});

await test("no script failed, and the content security policy refused nothing", () => assert.deepEqual(page.faults, []));

await accessibility(test, o, browser, page, address);
await phone(test, o, page, address);

if (!o.url && !o.mock) {
  await test("a served folder lists its files, and one is opened from it", async () => {
    const folder = await serve(o, dirname(dataFile(o)), { SERVE: "1" });
    const other = await openPage(browser, folder.url, {}, (p) => p.waitForSelector(".file-list"));
    await shot(o, other, "files");
    await other.click(`.file-list a:has-text("${basename(dataFile(o))}")`);
    await settled(other);
    assert.ok((await seen(other)).colors > 10);
    assert.deepEqual(other.faults, []);
    folder.stop();
  });
}

if (!o.url && !o.mock) await measuring(test, o, browser);
if (!o.url && !o.mock) await scene(test, o, browser);
if (!o.url && !o.mock) await wiring(test, o, browser);
if (!o.url && !o.mock) await views(test, o, browser);

if (!o.url) {
  const series = await serve(o, seriesFile(o), { MOCK_TIMES: "1" });
  const played = await openPage(browser, series.url);
  await test("times are stepped, dragged and played", async () => {
    const text = () => played.locator(".time-text").textContent();
    const before = await text();
    await andSettle(played, () => played.click("button[aria-label='One time on']"));
    assert.notEqual(await text(), before);
    await played.click("button[aria-label=Play]");
    const seenTimes = new Set();
    for (let i = 0; i < 40 && seenTimes.size < 3; i++) {
      seenTimes.add(await text());
      await played.waitForTimeout(150);
    }
    assert.ok(seenTimes.size >= 3, [...seenTimes].join(" | "));
    await played.click("button[aria-label=Pause]");
    await shot(o, played, "times");
    assert.deepEqual(played.faults, []);
  });
  await overTime(test, o, played);
}

await browser.close();
cleanUp();
console.log(`${passed} passed, ${failures} failed; the page weighs ${bytes} bytes compressed`);
process.exit(failures > 0 ? 1 : 0);
