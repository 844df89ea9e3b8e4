// SPDX-License-Identifier: Apache-2.0
// Measuring in the picture, numbers of selections, and plots over time.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { andSettle, dragOn, flatFile, middleOf, openPage, serve, settled, shot } from "./browser.mjs";

const words = (page, selector) => page.locator(selector).first().textContent();

async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return readFileSync(await download.path(), "utf8");
}

/** A square of 2 by 2 from above, in parallel projection, so that pixels are lengths. */
export async function measuring(test, o, browser) {
  const server = await serve(o, flatFile(o));
  const page = await openPage(browser, server.url);
  const picture = page.locator(".view-surface").first();
  await picture.focus();
  await andSettle(page, () => page.keyboard.press("5"));
  await andSettle(page, () => page.keyboard.press("p"));
  const [x, y] = await middleOf(picture);
  const now = () => words(page, ".measured-now");
  const placed = (count) => page.waitForFunction((n) => document.querySelectorAll(".measurement:not(.kept) .measured-place").length === n, count);
  const places = async (count, at) => {
    await placed(count - 1);
    await page.mouse.click(...at);
    await placed(count);
  };
  const distance = async () => Number(/distance ([\d.]+)/.exec(await now())[1]);

  await test("clicked places measure distances, angles and areas", async () => {
    await page.click("#tab-numbers");
    await picture.focus();
    await page.keyboard.press("d");
    await places(1, [x - 60, y]);
    await places(2, [x, y]);
    const one = await distance();
    await page.keyboard.press("Backspace");
    await places(2, [x + 60, y]);
    assert.ok(Math.abs((await distance()) / one - 2) < 0.02, "twice as far apart is twice the distance");
    await page.keyboard.press("Backspace");
    await places(2, [x, y]);
    await places(3, [x, y - 60]);
    assert.match(await now(), /angle (89\.9|90(\.0)?)\d*°/);
    const area = Number(/area ([\d.]+)/.exec(await now())[1]);
    assert.ok(Math.abs(area / (one * one / 2) - 1) < 0.02, "half a square");
    await page.locator(".measured-text").first().waitFor();
    await shot(o, page, "measured");
    await page.keyboard.press("Escape");
    await placed(0);
  });

  await test("typed places have a known distance, are kept by name and saved", async () => {
    const box = page.getByLabel("place x, y, z");
    for (const place of ["0, 0, 0", "0.3, 0.4, 0"]) {
      await box.fill(place);
      await box.press("Enter");
    }
    await page.waitForFunction(() => /distance 0\.5/.test(document.querySelector(".measured-now").textContent));
    await page.click("button:has-text('Keep')");
    await page.getByLabel("Name of measurement 1").fill("Gap");
    await page.getByLabel("Name of measurement 1").press("Enter");
    await page.waitForFunction(() => /Gap/.test(document.querySelector(".measured-text")?.textContent ?? ""));
    const file = await saved(page, "section:has(h2:text('Measured')) button:has-text('CSV')");
    assert.match(file, /^name,what,value,unit,note,places\r\nGap,distance,0\.5,/);
    // The session keeps them: in its file, for windows that come later, and taken back like other changes.
    await page.click("#tab-file");
    assert.match(await saved(page, "button:has-text('Save …')"), /measurements: .*Gap @ 0,0,0 0.3,0.4,0/);
    await page.reload();
    await settled(page);
    await page.click("#tab-numbers");
    assert.equal(await page.getByLabel("Name of measurement 1").inputValue(), "Gap");
    await page.locator(".measurement.kept").first().waitFor();
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => document.querySelector(".kept-name")?.value === "Measurement 1");
    await page.keyboard.press("Control+y");
    await page.waitForFunction(() => document.querySelector(".kept-name")?.value === "Gap");
    await picture.focus();
    await andSettle(page, () => page.keyboard.press("5"));
    await andSettle(page, () => page.keyboard.press("p"));
    await page.keyboard.press("d");
    await picture.focus();
    await page.keyboard.press("Enter"); // a place in the middle, without a mouse
    await placed(1);
    await page.waitForFunction(() => /one place/.test(document.querySelector(".measured-now").textContent));
    await page.keyboard.press("Escape");
  });

  await test("the numbers of all, of a rectangle and of an outline, which stays while the camera rests", async () => {
    await page.mouse.move(x, y);
    await page.mouse.move(x + 1, y);
    await page.waitForFunction(() => /\(.*\)/.test(document.querySelector(".probe").textContent));
    const from = Number(/\(([-\d.]+),/.exec(await words(page, ".probe"))[1]); // the x where the rectangle begins
    await page.click("button.primary:has-text('Measure')");
    await page.locator(".selected-facts").waitFor();
    const size = async () => Number(/area ([\d.]+)/.exec(await words(page, ".selected-facts"))[1]);
    const facts = () => words(page, ".selected-facts");
    const other = (before) => page.waitForFunction((t) => document.querySelector(".selected-facts").textContent !== t, before);
    assert.ok(Math.abs((await size()) - 4) < 1e-3, await facts());
    const all = await facts();
    await picture.focus();
    await page.keyboard.press("x");
    await dragOn(page, [x + 1, y - 250], [240, 500]); // all on the right
    await other(all);
    const half = await size();
    assert.ok(Math.abs(half - 2 * (1 - from)) < 0.13, `${half} beside ${from}`); // to a column of cells
    await page.locator(".outline").waitFor();
    await shot(o, page, "rectangle");
    const rectangle = await facts();
    await picture.focus();
    await page.keyboard.press("o");
    await page.mouse.move(x + 80, y);
    await page.mouse.down();
    for (let k = 1; k <= 40; k++) await page.mouse.move(x + 80 * Math.cos((k * Math.PI) / 20), y + 80 * Math.sin((k * Math.PI) / 20));
    await page.mouse.up();
    await other(rectangle);
    await shot(o, page, "lasso");
    const circle = await facts();
    await andSettle(page, () => picture.press("ArrowLeft"));
    assert.equal(await page.locator(".outline").count(), 0, "the outline goes when the camera turns");
    await page.click("button.primary:has-text('Measure')");
    await page.waitForTimeout(500);
    assert.equal(await facts(), circle, "but what it holds stays");
    const table = await saved(page, "section:has(h2:text('Numbers')) button:has-text('CSV')");
    assert.match(table, /^field,on,component,unit,count,missing,min,max,mean,deviation,median,integral\r\n/);
  });

  await test("a range of values selects, too, and a selection becomes steps", async () => {
    const before = await words(page, ".selected-facts");
    await page.getByLabel("by value").check();
    const box = page.getByLabel("to value as a number");
    await box.fill("-0.5");
    await box.press("Enter");
    await page.waitForFunction((t) => document.querySelector(".selected-facts").textContent !== t, before);
    const cells = /([\d,]+) cells/.exec(await words(page, ".selected-facts"))[1].replaceAll(",", "");
    await shot(o, page, "selected");
    await andSettle(page, () => page.click("button:has-text('As a step')"));
    await page.locator(".item:has-text('threshold')").waitFor();
    assert.match(await words(page, ".facts"), new RegExp(` ${cells} cells`), "the steps select the same cells");
    await page.click("#tab-numbers");
    await page.getByLabel("by value").uncheck();
    await page.click("button[aria-label='Without the outline']");
  });

  await test("nothing failed while measuring", () => assert.deepEqual(page.faults, []));
  await page.close();
  server.stop();
}

/** On a page of a series. */
export async function overTime(test, o, page) {
  await test("values at a clicked place are plotted over time, and saved", async () => {
    await page.click("#tab-plot");
    await settled(page);  // what is clicked is what is seen
    await page.mouse.click(...(await middleOf(page.locator(".view-surface").first())));
    await page.locator("button:has-text('At the clicked place'):not([disabled])").click();
    await page.waitForSelector(".over-time .uplot canvas");
    await settled(page);
    await shot(o, page, "over_time");
    const rows = (await saved(page, ".over-time button:has-text('CSV')")).trim().split("\r\n");
    assert.ok(rows[0].startsWith("time,"));
    assert.equal(rows.length, 4, "a row for each of three times");
    assert.ok((await saved(page, ".over-time button:has-text('Figure')")).startsWith("<svg"));
  });
}
