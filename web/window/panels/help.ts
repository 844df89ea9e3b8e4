// SPDX-License-Identifier: Apache-2.0
import { html, type TemplateResult } from "lit";
import type { App } from "../app";
import { keys } from "../input/keys";
import { dialog } from "./dialog";

const mouse: [string, string][] = [
  ["Drag", "the tool: turn, move, zoom, window and level, line, rectangle, outline"],
  ["Shift + drag, middle button", "move"],
  ["Ctrl + drag, right button, wheel", "zoom"],
  ["Two fingers", "move, zoom and roll"],
  ["Rest on the picture", "the value there"],
  ["Click", "keep that value: it is marked in the curve, and controls offer it"],
  ["Click with the tool “Measure”", "a place of a measurement"],
  ["Double click on a curve", "add or take away a point; Alt: without snapping, Shift: upwards only"],
];

const shown = (key: string): string =>
  key.replace("Arrow", "").replace("Control", "Ctrl").replace(/(^|\+)Left$/, "$1←").replace(/(^|\+)Right$/, "$1→").replace(/(^|\+)Up$/, "$1↑").replace(/(^|\+)Down$/, "$1↓");

export function helpDialog(app: App): TemplateResult {
  return dialog(app, "Help", html`<div class="help-columns" tabindex="0" role="region" aria-label="Mouse, touch and keys">
    <table><caption>Mouse and touch</caption><tbody>${mouse.map(([a, b]) => html`<tr><th scope="row">${a}</th><td>${b}</td></tr>`)}</tbody></table>
    <table><caption>Keys</caption><tbody>${keys.map((k) => html`<tr><th scope="row">${k.keys.map((x) => html`<kbd>${shown(x)}</kbd> `)}</th><td>${k.says}</td></tr>`)}</tbody></table>
  </div><p class="quiet">Arrow keys act on the view that has the focus. Every control has its help behind “?”.</p>`, true);
}
