// SPDX-License-Identifier: Apache-2.0
// Planes that are dragged in the picture, views whose cameras go together, and a picture that grows finer.
import assert from "node:assert/strict";
import { andSettle, ballFile, dataFile, dragOn, middleOf, openPage, seen, serve, settled, shot } from "./browser.mjs";
import { listenIn } from "./wire.mjs";

export async function views(test, o, browser) {
  const server = await serve(o, dataFile(o));
  const first = await openPage(browser, server.url);
  const page = await first.context().newPage();
  const heard = listenIn(page);
  await page.goto(first.url());
  await first.close();
  await settled(page);
  const tab = (name) => page.click(`#tab-${name}`);
  const undo = () => andSettle(page, () => page.click("button[aria-label=Undo]"));
  /** Three numbers of a step as the pipeline's file has them. */
  const numbersIn = async (step, word) => {
    await tab("file");
    const text = await page.locator("pre.code").first().textContent();
    await tab("steps");
    return new RegExp(`${step}:[^\\n]*${word}: \\[([^\\]]*)\\]`).exec(text)?.[1].split(",").map(Number);
  };

  await test("a plane is dragged by the pointer: the slice, the numbers of the step and of the recipe follow", async () => {
    await tab("steps");
    await page.click("text=+ Add");
    await page.locator("dialog input[type=search]").fill("slice");
    await page.waitForFunction(() => document.querySelector(".add-list li .name")?.textContent === "slice");
    await andSettle(page, () => page.keyboard.press("Enter"));
    await andSettle(page, () => page.getByLabel("Show input", { exact: true }).click());
    const plane = page.getByRole("slider", { name: "Plane of slice1" });
    const tip = plane.locator(".handle-dot").last();
    const height = () => plane.getAttribute("aria-valuetext").then((text) => Number(text.replace("−", "-")));
    const before = { at: await middleOf(tip), height: await height(), sum: (await seen(page)).sum };
    assert.equal(await numbersIn("slice1", "origin"), undefined);
    await andSettle(page, () => dragOn(page, before.at, [0, -70]));
    const after = await middleOf(tip);
    assert.ok(Math.abs(after[1] - (before.at[1] - 70)) < 3, `the handle stays below the pointer: ${before.at} ${after}`);
    assert.ok((await height()) > before.height + 1);
    assert.notEqual((await seen(page)).sum, before.sum, "another slice");
    const origin = await numbersIn("slice1", "origin");
    assert.ok(Math.abs(origin[2] - (await height())) < 0.01 * Math.abs(origin[2]), `${origin} ${await height()}`);
    assert.equal(Number(await page.getByLabel("origin z", { exact: true }).inputValue()), origin[2]);
    await shot(o, page, "plane_dragged");
    const slice = (await seen(page)).sum;
    await undo();
    assert.equal((await seen(page)).sum, before.sum, "the drag is one step");
    await andSettle(page, () => page.click("button[aria-label=Redo]"));
    assert.equal((await seen(page)).sum, slice);
    await undo();
    await undo();
    await undo();
  });

  await test("in the three-plane view the crosshair follows the pointer, and the recipe with it", async () => {
    await andSettle(page, () => page.click("button[aria-label='Three planes']"));
    await page.waitForFunction(() => document.querySelectorAll(".view").length === 4);
    await settled(page);
    await tab("steps");
    const cross = page.locator("[data-handle][aria-label^='Crosshair']").nth(1);
    const [x, y] = await middleOf(cross);
    const sums = [0, 1, 2, 3].map((i) => seen(page, i).then((s) => s.sum));
    const before = await Promise.all(sums);
    await andSettle(page, () => dragOn(page, [x, y], [36, -24]));
    const at = await middleOf(cross);
    assert.ok(Math.hypot(at[0] - x - 36, at[1] - y + 24) < 3, `${at} where the pointer is at ${[x + 36, y - 24]}`);
    const origin = await numbersIn("slice1", "origin");
    assert.ok(origin[0] > 0.5 && origin[2] > 0.5 && Math.abs(origin[1]) < 0.5, `seen from the front x and z change: ${origin}`);
    for (const i of [2, 3]) assert.notEqual((await seen(page, i)).sum, before[i], `view ${i + 1} shows another plane`);
    await shot(o, page, "crosshair_dragged");
    await andSettle(page, () => page.click("button[aria-label='One view']"));
    await undo();
    await undo();
  });

  await test("of two views with linked cameras one turns as the other is turned, or only goes along, or stays", async () => {
    await andSettle(page, () => page.click("button[aria-label='Two views']"));
    const link = page.getByLabel("Cameras go together");
    const cameras = () => [heard.draws[0].camera, heard.draws[1].camera];
    const pictures = async () => [(await seen(page, 0)).sum, (await seen(page, 1)).sum];
    const turn = async (how) => {
      await link.selectOption(how);
      const before = { cameras: cameras(), pictures: await pictures() };
      await andSettle(page, async () => dragOn(page, await middleOf(page.locator(".view-surface").first()), [60, 25]));
      return { before: before.cameras, after: cameras(), changed: (await pictures()).map((sum, i) => sum !== before.pictures[i]) };
    };
    const all = await turn("all");
    assert.deepEqual(all.changed, [true, true]);
    const [one, other] = [0, 1].map((i) => rotation(all.before[i], all.after[i]));
    assert.ok(one.some((x, i) => Math.abs(x - [1, 0, 0, 0, 1, 0, 0, 0, 1][i]) > 0.1), "it has turned");
    one.forEach((x, i) => assert.ok(Math.abs(x - other[i]) < 1e-6, "both by the same rotation"));
    await shot(o, page, "linked");
    const place = await turn("place");
    assert.deepEqual(place.changed, [true, false], "turning is left out");
    await page.locator(".view-surface").first().focus();
    const still = cameras()[1];
    await andSettle(page, () => page.keyboard.press("Shift+ArrowRight"));
    const moved = cameras().map((c, i) => c.target.map((x, k) => x - [place.after[0], still][i].target[k]));
    assert.ok(Math.hypot(...moved[0]) > 0.1);
    moved[0].forEach((x, k) => assert.ok(Math.abs(x - moved[1][k]) < 1e-6 * Math.hypot(...moved[0]), "the place goes along"));
    const none = await turn("none");
    assert.deepEqual(none.changed, [true, false]);
    await andSettle(page, () => page.click("button[aria-label='One view']"));
    assert.deepEqual(page.faults ?? [], []);
  });
  await page.context().close();
  server.stop();

  await growing(test, o, browser);
}

async function growing(test, o, browser) {
  const server = await serve(o, ballFile(o));
  const first = await openPage(browser, server.url, { viewport: { width: 860, height: 520 } });
  const page = await first.context().newPage();
  const heard = listenIn(page);
  await page.goto(first.url());
  await first.close();
  await settled(page);

  await test("a picture by paths of light grows: each that arrives is nearer to the last one, and says how exact it is", async () => {
    await page.click("#tab-look");
    await page.locator(".item-name:has-text('picture')").click();
    const word = (name) => page.locator(`[data-word=${name}]`);
    const fill = async (name, text) => {
      if ((await word(name).count()) === 0) await page.click(".more > summary");
      await word(name).locator("input[type=text]").fill(text);
      await word(name).locator("input[type=text]").press("Enter");
    };
    await andSettle(page, () => fill("noise", "0.002"));
    await andSettle(page, () => fill("paths", "240"));
    heard.frames.length = 0;
    await page.evaluate(keepPictures);
    if ((await word("integrator").count()) === 0) await page.click(".more > summary");
    await word("integrator").locator("select").selectOption("path");
    await page.waitForFunction(() => /paths a pixel/.test(document.querySelector(".facts-line")?.textContent ?? ""), null, { timeout: 60000 });
    await shot(o, page, "growing");
    await page.waitForTimeout(250);
    await settled(page, 120);
    await shot(o, page, "grown");
    const told = heard.frames.filter((f) => f.told);
    const errors = told.flatMap((f) => /standard error ([\d.]+)/.exec(f.told)?.slice(1).map(Number) ?? []);
    assert.ok(errors.length >= 3, `${heard.frames.length} pictures, ${told.length} of them told how exact they are`);
    assert.ok(told.slice(0, -1).every((f) => !f.final) && told.at(-1).final, "the last one alone is the final one");
    for (let i = 1; i < errors.length; i++) assert.ok(errors[i] <= errors[i - 1], `the error falls: ${errors.join(", ")}`);
    const apart = await page.evaluate(differences);
    assert.ok(apart.length >= 3, `${apart.length} pictures were seen`);
    assert.ok(apart[0] > 2 * apart.at(-2), `nearer to the last one: ${apart.map((x) => x.toFixed(2)).join(", ")}`);
  });
  await page.context().close();
  server.stop();
}

/** In the page: keeps each different picture of the first view from now on. */
function keepPictures() {
  const canvas = document.querySelector(".view canvas");
  window.kept = [];
  window.keeper = setInterval(() => {
    const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const last = window.kept.at(-1);
    if (!/paths a pixel/.test(document.querySelector(".facts-line")?.textContent ?? "")) return;
    if (!last || data.some((x, i) => x !== last[i])) window.kept.push(data);
  }, 200);
}

/** In the page: how far each of them is from the last one, as the mean over all numbers. */
function differences() {
  clearInterval(window.keeper);
  const last = window.kept.at(-1);
  return window.kept.map((data) => data.reduce((sum, x, i) => sum + Math.abs(x - last[i]), 0) / data.length);
}

/** The rotation that took one camera's frame to the other's, as nine numbers. */
function rotation(before, after) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (v) => v.map((x) => x / Math.hypot(...v));
  const frame = (c) => {
    const back = unit(c.position.map((x, i) => x - c.target[i]));
    const right = unit(cross(c.up, back));
    return [right, cross(back, right), back];
  };
  const [a, b] = [frame(before), frame(after)];
  return [0, 1, 2].flatMap((i) => [0, 1, 2].map((j) => b.reduce((sum, v, k) => sum + v[i] * a[k][j], 0)));
}
