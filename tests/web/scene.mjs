// SPDX-License-Identifier: Apache-2.0
// Lights, what is around, nodes and colours, each by its form.
import assert from "node:assert/strict";
import { noSeriousFindings } from "./access.mjs";
import { andSettle, ballFile, dragOn, openPage, seen, serve, settled, shot } from "./browser.mjs";

export async function scene(test, o, browser) {
  const server = await serve(o, ballFile(o));
  const page = await openPage(browser, server.url);
  const tab = (name) => page.click(`#tab-${name}`);
  const sum = async () => (await seen(page)).sum;
  const undo = () => andSettle(page, () => page.click("button[aria-label=Undo]"));
  const items = (n) => page.waitForFunction((count) => document.querySelectorAll(".panel .item").length === count, n);
  /** Drags the thumb of a slider. */
  const drag = async (slider, by) => {
    await slider.scrollIntoViewIfNeeded();
    const box = await slider.boundingBox();
    const share = await slider.evaluate((e) => (Number(e.value) - Number(e.min)) / (Number(e.max) - Number(e.min)));
    await andSettle(page, () => dragOn(page, [box.x + 8 + share * (box.width - 16), box.y + box.height / 2], [by, 0]));
  };
  /** Types into a box of the form. */
  const type = (box, text) =>
    andSettle(page, async () => {
      await box.fill(text);
      await box.press("Enter");
    });
  const shots = async (name) => {
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(200);
      await noSeriousFindings(page, `${name}, ${colorScheme}`);
      await shot(o, page, `${name}_${colorScheme}`);
    }
    await page.emulateMedia({ colorScheme: "light" });
  };

  await test("a light is added, its strength dragged, a mistake stands at its control, it is removed and comes back", async () => {
    await tab("scene");
    await shots("scene");
    const dark = await sum();
    await andSettle(page, () => page.getByLabel("Add a light").selectOption("sphere"));
    await items(1);
    const slider = page.locator("[data-word=brightness] input[type=range]");
    const box = page.locator("[data-word=brightness] input[type=text]");
    const usual = await sum();
    await drag(slider, -25);
    assert.ok(Number(await box.inputValue()) < 1, await box.inputValue());
    assert.notEqual(await sum(), usual, "the picture follows");
    await undo();
    assert.equal(await sum(), usual, "a drag is one step");
    await type(box, "-2");
    await page.waitForSelector("[data-word=brightness] .problem");
    assert.equal(await box.getAttribute("aria-invalid"), "true");
    await type(box, "0.5");
    await page.waitForSelector("[data-word=brightness] .problem", { state: "detached" });
    await andSettle(page, () => page.locator("[data-word=from] select").selectOption("right"));
    await type(page.locator("[data-word=azimuth] input[type=text]"), "20");
    assert.match(await page.locator("[data-word=azimuth] .problem").textContent(), /stated twice/);
    await shots("light");
    const lit = await sum();
    await andSettle(page, () => page.click("button[aria-label='Remove light 1, sphere']"));
    await items(0);
    assert.equal(await sum(), dark, "as before");
    await undo();
    await items(1);
    assert.equal(await sum(), lit);
  });

  await test("what is around is chosen, set, and usual again", async () => {
    await tab("scene");
    const around = page.getByLabel("What is around");
    await andSettle(page, () => around.selectOption("even"));
    const form = page.locator("section:has(h2:text('Around'))");
    await form.locator("[data-word=background] input").check();
    await andSettle(page, () => form.locator("[data-word=color] input[type=color]").fill("#ffaa33"));
    assert.equal(await form.locator("[data-word=color] input[type=text]").inputValue(), "#ffaa33");
    await shots("around");
    await tab("file");
    assert.match(await page.locator("pre.code").first().textContent(), /environment: .*even background=true color=#ffaa33/);
    await tab("scene");
    await andSettle(page, () => around.selectOption("sky"));
    await form.locator("[data-word=elevation]").waitFor();
    await andSettle(page, () => around.selectOption(""));
    await form.locator("[data-word]").first().waitFor({ state: "detached" });
    await tab("file");
    assert.doesNotMatch(await page.locator("pre.code").first().textContent(), /environment/);
    await tab("scene");
  });

  await test("what is shown goes into a node, which is moved by typing and dragging, and undone", async () => {
    await tab("scene");
    await andSettle(page, () => page.getByLabel("Add a node", { exact: true }).selectOption({ index: 1 }));
    await page.waitForSelector("h2:text-matches('^Node ')");
    const still = await sum();
    await type(page.getByLabel("translate x", { exact: true }), "0.5");
    const moved = await sum();
    assert.notEqual(moved, still, "it stands elsewhere");
    await drag(page.getByLabel("Drag: translate z"), 12);
    assert.ok(Number(await page.getByLabel("translate z", { exact: true }).inputValue()) > 0);
    assert.notEqual(await sum(), moved);
    await shots("node");
    await undo();
    assert.equal(await sum(), moved, "a drag is one step");
    await type(page.locator("[data-word=scale] input[type=text]"), "0");
    await page.waitForSelector("[data-word=scale] .problem");
    await type(page.locator("[data-word=scale] input[type=text]"), "");
    await andSettle(page, () => page.click("button:text-is('Take out')"));
    assert.equal(await sum(), still, "out of the node it is where the data lie");
    await andSettle(page, () => page.locator("button[aria-label^='Remove node']").click());
    await page.waitForSelector("h2:text-matches('^Node ')", { state: "detached" });
  });

  await test("a node moves by keys, and stands in copies, listed or at points", async () => {
    await tab("scene");
    const still = await sum();
    await andSettle(page, () => page.getByLabel("Add a node", { exact: true }).selectOption({ index: 1 }));
    await page.waitForSelector("h2:text-matches('^Node ')");
    const entry = (name) => page.locator(`.panel li:has(button[aria-label='Remove ${name}'])`);
    const box = (name, word) => entry(name).getByLabel(word, { exact: true });
    await andSettle(page, () => page.click("button:text-is('+ key')"));
    await entry("time 0").waitFor();
    await andSettle(page, () => page.click("button:text-is('+ key')"));
    await type(box("time 1", "translate x"), "2");
    assert.equal(await sum(), still, "at the first key it is where it was");
    const time = page.locator(".panel [data-word=time] input[type=text]").first();
    await type(time, "1");
    const moved = await sum();
    assert.notEqual(moved, still, "at the second one elsewhere");
    await shots("keys");
    await type(entry("time 1").locator("[data-word=time] input[type=text]"), "0");
    await page.waitForSelector("[data-word=time] .problem:has-text('does not come after')");
    await type(entry("time 1").locator("[data-word=time] input[type=text]"), "1");
    await andSettle(page, () => page.click("button[aria-label='Remove time 1']"));
    assert.equal(await sum(), still, "the first key stays");
    await undo();
    assert.equal(await sum(), moved);

    await andSettle(page, () => page.click("button:text-is('+ copy')"));
    await andSettle(page, () => page.click("button:text-is('+ copy')"));
    await type(box("copy 2", "translate z"), "2.5");
    const twice = await sum();
    assert.notEqual(twice, moved, "two of them");
    await shots("copies");
    const points = page.getByLabel(/^Copies of .* at the points of$/);
    await andSettle(page, () => points.selectOption({ index: 1 }));
    await page.locator("[data-word=vectors]").waitFor();
    assert.equal(await page.locator("button[aria-label^='Remove copy']").count(), 0, "points take the place of the list");
    await undo();
    assert.equal(await sum(), twice);
    await andSettle(page, () => page.locator("button[aria-label^='Remove node']").click());
    await page.waitForSelector("h2:text-matches('^Node ')", { state: "detached" });
    for (let i = 0; i < 2; i++) await undo();
    await andSettle(page, () => page.locator("button[aria-label^='Remove node']").click());
  });

  await test("colours are picked, as a word and as three numbers", async () => {
    await tab("look");
    await page.locator(".item-name").first().click();
    const before = await sum();
    const word = (name) => page.locator(`[data-word=${name}]`);
    if ((await word("color").count()) === 0) await page.click(".more > summary");
    await andSettle(page, () => word("color").locator("input[type=color]").fill("#2266dd"));
    assert.equal(await word("color").locator("input[type=text]").inputValue(), "#2266dd");
    assert.notEqual(await sum(), before);
    if ((await word("transmission_color").count()) === 0) await page.click(".more > summary");
    await andSettle(page, () => word("transmission_color").locator("input[type=color]").fill("#808080"));
    assert.equal(await word("transmission_color").locator("input[type=text]").inputValue(), "0.216,0.216,0.216");
    await type(word("emission").locator("input[type=text]"), "red");
    assert.equal(await word("emission").locator("input[type=text]").inputValue(), "1,0,0");
    await word("transmission_color").scrollIntoViewIfNeeded();
    await shots("colours");
    assert.deepEqual(page.faults, []);
  });

  await settled(page);
  await page.context().close();
  server.stop();
}
