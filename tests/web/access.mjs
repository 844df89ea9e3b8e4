// SPDX-License-Identifier: Apache-2.0
// Accessibility in both themes, and the window on a phone.
import assert from "node:assert/strict";
import { AxeBuilder, andSettle, ownPage, seen, settled, shot } from "./browser.mjs";

export async function noSeriousFindings(page, where) {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter((v) => v.impact === "serious" || v.impact === "critical");
  assert.deepEqual(serious.map((v) => `${where}: ${v.id}: ${v.nodes.slice(0, 3).map((n) => n.html.slice(0, 140)).join(" | ")}`), []);
}

export async function accessibility(test, o, browser, page, address) {
  for (const colorScheme of ["light", "dark"]) {
    await test(`accessible in the ${colorScheme} theme`, async () => {
      const other = await page.context().newPage();
      await other.emulateMedia({ colorScheme });
      await other.goto(address);
      await settled(other);
      assert.equal(await other.evaluate(() => document.documentElement.dataset.theme), colorScheme);
      for (const name of ["steps", "look", "scene", "color", "table", "plot", "numbers", "file"]) {
        await other.click(`#tab-${name}`);
        await other.waitForTimeout(300);
        await noSeriousFindings(other, name);
        await shot(o, other, `${colorScheme}_${name}`);
      }
      await other.locator(".view-surface").first().focus();
      for (const key of ["?", "a", "s"]) {
        await other.keyboard.press(key);
        await other.waitForSelector("dialog[open]");
        await noSeriousFindings(other, `dialog ${key}`);
        await shot(o, other, `${colorScheme}_dialog`);
        await other.keyboard.press("Escape");
        await other.waitForSelector("dialog", { state: "detached" });
      }
      await other.close();
    });
  }

  await test("everything can be reached by keyboard, each with a name and a visible focus", async () => {
    const other = await page.context().newPage();
    await other.goto(address);
    await settled(other);
    const names = new Set();
    for (let i = 0; i < 60; i++) {
      await other.keyboard.press("Tab");
      const at = await other.evaluate(() => {
        const e = document.activeElement;
        const named = e.getAttribute("aria-label") ?? e.labels?.[0]?.textContent ?? e.textContent;
        const style = getComputedStyle(e);
        const holder = e.closest(".select-icon");
        const ring = (s) => s.outlineStyle !== "none" && parseFloat(s.outlineWidth) > 0;
        const inner = [...e.querySelectorAll("*")].some((x) => parseFloat(getComputedStyle(x).strokeWidth) >= 2);
        return { name: named?.trim() ?? "", ring: ring(style) || (holder !== null && ring(getComputedStyle(holder))) || inner, tag: e.tagName };
      });
      if (at.tag === "BODY") continue;
      assert.notEqual(at.name, "", `a ${at.tag} without a name`);
      assert.ok(at.ring, `no focus ring on ${at.name}`);
      names.add(at.name);
    }
    for (const wanted of ["Tool: Turn", "Save the picture"]) assert.ok(names.has(wanted), `${wanted} in ${[...names].join(", ")}`);
    await other.close();
  });
}

export async function phone(test, o, page, address) {
  await test("on a phone the panel is a sheet, nothing overflows, and a finger turns", async () => {
    const browser = page.context().browser();
    const context = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2, storageState: await page.context().storageState() });
    if (o.dist) await ownPage(context);
    const small = await context.newPage();
    await small.goto(address);
    await settled(small);
    await shot(o, small, "phone");
    assert.ok(await small.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
    const canvas = await small.evaluate(() => document.querySelector(".view canvas").width / document.querySelector(".view canvas").clientWidth);
    assert.ok(Math.abs(canvas - 2) < 0.05, "as many pixels as the screen has");
    const before = (await seen(small)).sum;
    const touch = await context.newCDPSession(small);
    const box = await small.locator(".view-surface").boundingBox();
    const at = (x, y, id = 0) => ({ x: box.x + x, y: box.y + y, id });
    await andSettle(small, async () => {
      await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [at(150, 150)] });
      for (let i = 1; i <= 8; i++) {
        await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [at(150 + i * 10, 150 + i * 3)] });
        await small.waitForTimeout(16);
      }
      await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    });
    const turned = (await seen(small)).sum;
    assert.notEqual(turned, before);
    await andSettle(small, async () => {
      await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [at(120, 150), at(220, 150, 1)] });
      for (let i = 1; i <= 8; i++) {
        await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [at(120 - i * 5, 150), at(220 + i * 5, 150, 1)] });
        await small.waitForTimeout(16);
      }
      await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    });
    assert.notEqual((await seen(small)).sum, turned);
    await small.click("button[aria-label=Panel]");
    await small.waitForSelector(".panel");
    await small.click("#tab-color");
    await small.waitForTimeout(400);
    await shot(o, small, "phone_panel");
    assert.ok(await small.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
    await context.close();
  });
}
