// SPDX-License-Identifier: Apache-2.0
// Buttons for views, projection, axes, the picture as a file, and what the page tells of itself.
import type { Viewer } from "../viewer";
import { button, element } from "./dom";

export interface Toolbar {
  bar: HTMLElement;
  keys: Record<string, () => void>;
}

export function makeToolbar(v: Viewer, title: string, more: HTMLElement[]): Toolbar {
  const bar = element("div", { className: "bar", role: "toolbar", ariaLabel: "Camera" }), keys: Toolbar["keys"] = {};
  const go = (name: string) => () => {
    const view = v.scene.views[name];
    v.camera.fit(v.step.box ?? v.step.bounds, view.direction, view.up, v.aspect(), v.scene.margin);
    v.draw(false);
  };
  Object.keys(v.scene.views).forEach((name, i) => {
    bar.append(button(name, `View: ${name} (${i + 1})`, go(name)));
    keys[String(i + 1)] = go(name);
  });
  const reset = () => { v.camera.set(v.first.copy()), v.draw(false); };
  const project = () => {
    v.camera.setParallel(!v.camera.parallel);
    projection.textContent = v.camera.parallel ? "parallel" : "perspective";
    v.draw(false);
  };
  const axes = () => { v.axes = !v.axes, v.draw(false); };
  const projection = button(v.camera.parallel ? "parallel" : "perspective", "Perspective or parallel projection (p)", project);
  keys.r = reset, keys.p = project, keys.a = axes;
  bar.append(button("reset", "The view of the picture (r)", reset), projection);
  if (v.step.annotation.axes) bar.append(button("axes", "Box, numbers and orientation (a)", axes));
  bar.append(button("save", "Save what is seen as PNG", () => {
    v.snapshot().toBlob((blob) => {
      if (!blob) return;
      const link = element("a", { href: URL.createObjectURL(blob), download: `${title || "picture"}.png` });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    });
  }));
  bar.append(...more);
  return { bar, keys };
}

/** What differs from the picture's data, and how the page is used. */
export function makeAbout(notes: string[], recipe: string): HTMLDetailsElement {
  const list = element("ul", {}, ...notes.map((n) => element("li", { textContent: n })));
  const how = "Drag turns, with shift or the right button it shifts, with ctrl it rolls; the wheel zooms; arrows, + and − too.";
  const about = element("details", { className: "about" }, element("summary", { textContent: "about", title: "What is in this page" }), element("p", { textContent: how }));
  if (notes.length) about.append(element("p", { textContent: "To keep within its size, or for speed:" }), list);
  if (recipe) about.append(element("p", { textContent: "The picture's pipeline:" }), element("pre", { textContent: recipe }));
  return about;
}
