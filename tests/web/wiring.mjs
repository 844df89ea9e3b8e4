// SPDX-License-Identifier: Apache-2.0
// A pipeline that forks and joins: what a step takes, steps between others, steps that go.
import assert from "node:assert/strict";
import { noSeriousFindings } from "./access.mjs";
import { andSettle, dataFile, openPage, seen, serve, shot } from "./browser.mjs";

export async function wiring(test, o, browser) {
  const server = await serve(o, dataFile(o));
  const page = await openPage(browser, server.url);
  /** Its panel is there when the tab says so: until then the one before it is. */
  const tab = async (name) => {
    await page.click(`#tab-${name}`);
    await page.waitForSelector(`#tab-${name}[aria-selected="true"]`);
  };
  const as = (what) => page.locator(`.segmented >> text=${what}`).click();
  const step = (name) => page.locator(`.item-name[aria-pressed]:has(span:text-is("${name}"))`).first();
  const input = (i) => page.locator(`[data-input="${i}"] select`);
  /** Chooses what stands first once that was typed into the search for operations. */
  const take = async (words, operation) => {
    await page.locator("dialog[open] input[type=search]").fill(words);
    await page.waitForFunction((name) => document.querySelector(".add-list li .name")?.textContent === name, operation);
    await page.keyboard.press("Enter");
    await page.waitForSelector(`h2:text-is("${operation.replaceAll(" ", "_")}1")`);
    await andSettle(page, () => undefined);
  };
  /** The pipeline's file, once it has that in it. */
  const file = async (pattern) => {
    await tab("file");
    const text = () => page.locator("pre.code").first().textContent();
    for (let i = 0; i < 100 && !pattern.test(await text()); i++) await page.waitForTimeout(50);
    assert.match(await text(), pattern);
    await tab("steps");
    return text;
  };
  let source = "";

  await test("a branch is made and joined with the trunk by a step of several inputs", async () => {
    await tab("steps");
    source = await page.locator(".item-name span").first().textContent();
    await page.click("text=+ Add");
    await take("isosurf", "contour");
    await step(source).click();
    await page.click("button:text-is('+ after')");
    await take("slice", "slice");
    await step("contour1").click();
    await page.click("button:text-is('+ after')");
    await take("append", "append");
    assert.equal(await page.locator("[data-input]").count(), 2, "what it takes, and room for more");
    await shot(o, page, "inputs");
    const before = (await seen(page)).sum;
    await andSettle(page, () => input(1).selectOption("slice1"));
    await page.waitForFunction(() => document.querySelectorAll("[data-input]").length === 3);
    assert.notEqual((await seen(page)).sum, before, "both are seen");
    await file(/append1:.*from: \[contour1, slice1\]/s);
    await step("append1").click();
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      await as("graph");
      await page.waitForFunction(() => document.querySelectorAll(".edge").length === 4);
      await noSeriousFindings(page, `inputs, ${colorScheme}`);
      await shot(o, page, `joined_${colorScheme}`);
    }
    await page.emulateMedia({ colorScheme: "light" });
  });

  await test("what hangs on a step is not offered to it, and a circle is refused with a sentence", async () => {
    await as("list");
    await step("contour1").click();
    await page.waitForSelector("[data-input='0']");
    assert.deepEqual(await input(0).locator("option").evaluateAll((all) => all.map((x) => x.value)), [source, "slice1"]);
    // As another window may ask for it that has not heard of the newest state.
    await input(0).evaluate((select) => {
      select.append(new Option("append1", "append1"));
      select.value = "append1";
      select.dispatchEvent(new Event("change"));
    });
    await page.waitForSelector(".panel .problem:has-text('in a circle')");
    assert.equal(await input(0).inputValue(), source, "it takes what it took");
    await shot(o, page, "circle");
  });

  await test("an edge is drawn in the graph by hand, to a free input and in place of another; one that closes a circle is refused", async () => {
    await as("graph");
    await page.waitForSelector(".port.out");
    const before = (await seen(page)).sum;
    const middle = async (locator) => {
      const box = await locator.boundingBox();
      return [box.x + box.width / 2, box.y + box.height / 2];
    };
    /** From below a step to somewhere on the box of another, `across` as a share of it. */
    const draw = async (from, to, across, look) => {
      const at = await middle(page.locator(`.port.out[data-from="${from}"]`));
      const box = await page.locator(`.node[aria-label^="${to}:"] rect`).boundingBox();
      await page.mouse.move(...at);
      await page.mouse.down();
      await page.mouse.move(at[0] + 5, at[1] + 12);
      await page.mouse.move(box.x + across * box.width, box.y + box.height / 2, { steps: 4 });
      await page.waitForSelector(".port.over");
      await look?.();
      await page.mouse.up();
      await page.waitForSelector(".edge.drawn", { state: "detached" });
    };
    await andSettle(page, () => draw(source, "append1", 0.95, () => shot(o, page, "drawing_edge")));
    await file(new RegExp(`append1:.*from: \\[contour1, slice1, ${source}\\]`, "s"));
    await andSettle(page, () => draw("slice1", "append1", 0.05));
    await file(new RegExp(`append1:.*from: \\[slice1, slice1, ${source}\\]`, "s"));
    await draw("append1", "slice1", 0.5);
    await page.waitForSelector(".panel .problem:has-text('in a circle')");
    await shot(o, page, "drawn_circle");
    for (let i = 0; i < 2; i++) await andSettle(page, () => page.click("button[aria-label=Undo]"));
    await file(/append1:.*from: \[contour1, slice1\]/s);
    assert.equal((await seen(page)).sum, before, "two steps back");
    // Let go beside all boxes, it goes nowhere.
    const at = await middle(page.locator(`.port.out[data-from="${source}"]`));
    await page.mouse.move(...at);
    await page.mouse.down();
    await page.mouse.move(at[0] - 200, at[1], { steps: 3 });
    await page.waitForSelector(".edge.drawn");
    await page.mouse.up();
    await page.waitForSelector(".edge.drawn", { state: "detached" });
    assert.equal(await page.locator(".edge").count(), 4);
    await noSeriousFindings(page, "ports");
  });

  await test("a step is put between two in the graph, by keys, and taken back", async () => {
    const before = (await seen(page)).sum;
    await as("graph");
    await page.getByRole("button", { name: "Insert between contour1 and append1" }).focus();
    await shot(o, page, "insert_focus");
    await page.keyboard.press("Enter");
    await page.waitForSelector("dialog[open]");
    assert.ok(await page.getByLabel("append1", { exact: true }).isChecked());
    await noSeriousFindings(page, "insert");
    await shot(o, page, "insert");
    await take("mirror", "mirror");
    await file(/append1:.*from: \[mirror1, slice1\]/s);
    await page.waitForFunction(() => document.querySelectorAll(".edge").length === 5);
    await shot(o, page, "inserted");
    assert.notEqual((await seen(page)).sum, before);
    await andSettle(page, () => page.click("button[aria-label=Undo]"));
    await file(/append1:.*from: \[contour1, slice1\]/s);
    assert.equal((await seen(page)).sum, before, "one step back");
    await andSettle(page, () => page.click("button[aria-label=Redo]"));
    await file(/mirror1:/);
  });

  await test("a step goes in front of all that takes one, and leaves it to its input when it is removed", async () => {
    await as("list");
    await step(source).click();
    await page.click("button:text-is('+ between')");
    await page.waitForSelector("dialog[open] [aria-label='In front of']");
    const ticks = page.locator("dialog [aria-label='In front of'] input");
    assert.deepEqual(await ticks.evaluateAll((all) => all.map((x) => x.checked)), [true, true, true], "two steps and what is shown");
    await shot(o, page, "between");
    await ticks.last().uncheck();
    await take("gauss", "gaussian smooth");
    await file(/slice1:.*from: gaussian_smooth1/s);
    const text = await file(/contour1:.*from: gaussian_smooth1/s);
    await step("gaussian_smooth1").click();
    await andSettle(page, () => page.click("button[aria-label='Remove gaussian_smooth1']"));
    await page.waitForSelector(`h2:text-is("gaussian_smooth1")`, { state: "detached" });
    await tab("file");
    assert.doesNotMatch(await text(), /gaussian_smooth1/);
    await tab("steps");
    assert.equal(await page.locator(".panel .problem").count(), 0);
  });

  await test("what is shown may be of another step, with the same words", async () => {
    await tab("look");
    await page.locator(".item-name:has-text('of contour1')").first().click();
    const of = page.getByLabel("Step that is shown");
    const before = (await seen(page)).sum;
    await andSettle(page, () => of.selectOption("mirror1"));
    await page.waitForSelector(".item-name:has-text('of mirror1')");
    assert.notEqual((await seen(page)).sum, before);
    await noSeriousFindings(page, "look");
    await shot(o, page, "shown_of");
    await andSettle(page, () => page.click("button[aria-label=Undo]"));
    await page.waitForSelector(".item-name:has-text('of contour1')");
    assert.equal((await seen(page)).sum, before);
    assert.deepEqual(page.faults, []);
  });

  await page.context().close();
  server.stop();
}
