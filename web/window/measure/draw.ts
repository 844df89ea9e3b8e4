// SPDX-License-Identifier: Apache-2.0
// Measurements and outlines of selections over the picture.
import { nothing, svg, type SVGTemplateResult } from "lit";
import type { App } from "../app";
import { placeInView } from "../camera/projection";
import type { Vec3 } from "../protocol";
import type { View } from "../view/view";
import { measured, mostUneven, unevenness } from "./geometry";
import { measuredText } from "./rulers";

type Pixel = [number, number];

/** In coordinates of the part beside the legends. */
export function measurements(app: App, view: View): unknown {
  const { points, kept } = app.rulers;
  if (!view.camera || (points.length === 0 && kept.length === 0)) return nothing;
  return svg`${kept.map((m) => one(app, view, m.points, m.name))}${one(app, view, points, "")}`;
}

function one(app: App, view: View, points: Vec3[], name: string): SVGTemplateResult | typeof nothing {
  const at = points.map((p) => placeInView(app.state, view.camera!, view.area, p)).filter((p): p is Pixel => p !== null);
  if (at.length === 0 || at.length < points.length) return nothing; // a part of it lies behind the viewer
  const list = at.map((p) => `${p[0].toFixed(1)},${p[1].toFixed(1)}`).join(" ");
  const numbers = measured(points);
  const unit = app.state?.length_unit ?? "";
  // A number alone is a distance or, with its sign, an angle; others say what they are.
  const texts = numbers.map((m) => `${m.what === "area" || m.what === "length" ? `${m.what} ` : ""}${measuredText(m, unit)}`);
  if (points.length > 3 && unevenness(points) > mostUneven) texts.push("not flat");
  // Of two the label stands at the middle, of three the angle at its place, else all of them in the middle of the corners.
  const middle: Pixel = [at.reduce((s, p) => s + p[0], 0) / at.length, at.reduce((s, p) => s + p[1], 0) / at.length];
  const angle = numbers[0]?.what === "angle";
  const labels: [Pixel, string][] = texts.length === 0 ? [] : angle ? [[at[1], texts[0]], [middle, texts[1]]] : [[middle, texts.join(" · ")]];
  return svg`<g class="measurement ${name ? "kept" : ""}">
    ${at.length > 2 ? svg`<polygon class="measured-area" points=${list} />` : nothing}
    <polyline class="measured-under" points=${list} /><polyline class="measured-line" points=${list} />
    ${at.map((p) => svg`<circle class="measured-place" cx=${p[0]} cy=${p[1]} r="3.5" />`)}
    ${labels.map(([p, text], i) => svg`<text class="measured-text" x=${p[0] + 8} y=${p[1] - 8}>${i === 0 && name ? `${name}: ` : ""}${text}</text>`)}
  </g>`;
}

/** The outline of a selection as it is drawn, and then while the camera rests. */
export function selectionOutline(app: App, view: View): unknown {
  const points = app.selections.outlineIn(view);
  if (points.length < 2) return nothing;
  const list = points.map((p) => `${p[0].toFixed(1)},${p[1].toFixed(1)}`).join(" ");
  return svg`<polygon class="outline-under" points=${list} /><polygon class="outline" points=${list} />`;
}
