// SPDX-License-Identifier: Apache-2.0
// Two-dimensional transfer functions: widgets over the histogram of value and gradient magnitude.
import { icon } from "../icons";
import { html, nothing, svg, type SVGTemplateResult, type TemplateResult } from "lit";
import { ref } from "lit/directives/ref.js";
import { beginDrag } from "../input/handle";
import type { PlaneAnswer } from "../protocol";
import { plain } from "../words";
import { hexOf } from "../controls/color";
import { width, type Curve } from "./curve";
import { corners, gripped, newWidget, parseWidgets, widgetsText, type Grip, type Widget } from "./widgets";

const height = 170;
const ui = { chosen: 0 };
const palette = ["tomato", "gold", "mediumseagreen", "steelblue", "orchid"];

export function planeEditor(c: Curve): TemplateResult {
  const at = `show/${c.index}`;
  const text = c.app.session.word(at, "widgets") ?? "";
  const list = parseWidgets(text, c.range) ?? [];
  // Widgets take the place of a curve: the two exclude each other.
  const exclusive: Record<string, null> = c.app.session.word(at, "opacity") === undefined ? {} : { opacity: null };
  const problem = c.app.session.edits.problem(at, "widgets");
  const counts = c.app.histograms.plane(c.index);
  const set = (next: Widget[], live = false): void =>
    c.app.session.set(at, next.length > 0 ? { widgets: widgetsText(next), ...exclusive } : { widgets: null }, live);
  const add = (shape: Widget["shape"]): void => {
    ui.chosen = list.length;
    set([...list, newWidget(shape, c.range, palette[list.length % palette.length])]);
  };
  const w = list[ui.chosen];
  return html`<div class="plane">
    <div class="plane-box">
      <canvas class="plane-counts" aria-hidden="true" ${ref((e) => e && paint(e as HTMLCanvasElement, counts))}></canvas>
      <svg viewBox="0 0 ${width} ${height}" role="group" aria-label="Widgets over value (to the right) and gradient (upwards)">
        ${list.map((x, i) => widget(c, list, x, i, set))}
      </svg>
    </div>
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    <p class="quiet axis-names"><span>${plain(c.range[0])}</span><span>value → · gradient ↑</span><span>${plain(c.range[1])}</span></p>
    <div class="row">
      <button class="small" @click=${() => add("triangle")}>+ triangle</button>
      <button class="small" @click=${() => add("rectangle")}>+ rectangle</button>
      ${list.length > 0 ? html`<button class="small" @click=${() => set([])}>Remove all</button>` : nothing}
    </div>
    ${w ? details(list, w, set) : html`<p class="quiet">Widgets pick out materials and their borders; they replace the opacity curve.</p>`}
  </div>`;
}

function details(list: Widget[], w: Widget, set: (next: Widget[], live?: boolean) => void): TemplateResult {
  const change = (part: Partial<Widget>, live: boolean): void => set(list.map((x, i) => (i === ui.chosen ? { ...x, ...part } : x)), live);
  return html`<div class="row">
    <input type="color" aria-label="Colour of the widget" .value=${hexOf(w.color === "map" ? "" : w.color)} @input=${(e: Event) => change({ color: (e.target as HTMLInputElement).value }, true)} @change=${(e: Event) => change({ color: (e.target as HTMLInputElement).value }, false)} />
    <label class="grow row">opacity <input class="grow" type="range" min="0" max="1" step="0.01" .value=${String(w.opacity)} aria-label="Opacity of the widget"
      @input=${(e: Event) => change({ opacity: Number((e.target as HTMLInputElement).value) }, true)} @change=${(e: Event) => change({ opacity: Number((e.target as HTMLInputElement).value) }, false)} /></label>
    <button class="small" aria-pressed=${w.color === "map" ? "true" : "false"} @click=${() => change({ color: w.color === "map" ? "tomato" : "map" }, false)}>map's colour</button>
    <button class="icon small" aria-label="Remove the widget" @click=${() => set(list.filter((_, i) => i !== ui.chosen))}>${icon("close")}</button>
  </div>`;
}

function widget(c: Curve, list: Widget[], w: Widget, i: number, set: (next: Widget[], live?: boolean) => void): SVGTemplateResult {
  const px = (p: [number, number]): [number, number] => [p[0] * width, (1 - p[1]) * height];
  const shape = corners(w, c.range).map(px);
  const middle = (a: [number, number], b: [number, number]): [number, number] => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const [top, bottom] = w.shape === "triangle" ? [middle(shape[1], shape[2]), shape[0]] : [middle(shape[2], shape[3]), middle(shape[0], shape[1])];
  const [low, high] = w.shape === "triangle" ? [shape[2], shape[1]] : [middle(shape[0], shape[3]), middle(shape[1], shape[2])];
  const put = (next: Widget, live: boolean): void => set(list.map((x, k) => (k === i ? next : x)), live);
  const drag = (grip: Grip) => (e: PointerEvent): void => {
    const box = (e.currentTarget as Element).closest("svg")!.getBoundingClientRect();
    ui.chosen = i;
    c.app.changed();
    beginDrag(e, () => ({ move: (dx, dy, done) => put(gripped(w, grip, dx / box.width, -dy / box.height, c.range), !done) }));
  };
  const keyed = (e: KeyboardEvent): void => {
    const by = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as Record<string, [number, number]>)[e.key];
    if (e.key === "Delete" || e.key === "Backspace") set(list.filter((_, k) => k !== i));
    else if (by) put(gripped(w, e.shiftKey ? (by[0] !== 0 ? "high" : "top") : "body", by[0] * 0.02, by[1] * 0.02, c.range), false);
    else return;
    e.preventDefault();
  };
  const fill = w.color === "map" ? "#999999" : hexOf(w.color);
  const grips: [Grip, [number, number]][] = [["low", low], ["high", high], ["top", top], ["bottom", bottom]];
  return svg`<g class="widget ${i === ui.chosen ? "chosen" : ""}">
    <path tabindex="0" role="button" aria-label="${w.shape} from ${plain(w.low)} to ${plain(w.high)}; arrow keys move it, with shift they resize it"
      d="M${shape.map((p) => p.map((q) => q.toFixed(1)).join(" ")).join("L")}Z" fill=${fill} fill-opacity=${0.25 + 0.5 * w.opacity}
      @pointerdown=${drag("body")} @keydown=${keyed} @focus=${() => { ui.chosen = i; }} />
    ${i === ui.chosen ? grips.map(([g, p]) => svg`<circle class="grip" cx=${p[0]} cy=${p[1]} r="5" @pointerdown=${drag(g)} />`) : nothing}
  </g>`;
}

/** The counts as greys, logarithmically: few voxels of a border must be seen beside millions of air. */
function paint(canvas: HTMLCanvasElement, plane: PlaneAnswer | null): void {
  const key = plane ? String(plane.n) : "none";
  if (canvas.dataset.key === key) return;
  canvas.dataset.key = key;
  if (!plane) return;
  const [w, h] = plane.size;
  canvas.width = w;
  canvas.height = h;
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(w, h);
  const top = Math.log1p(Math.max(...plane.counts, 1));
  for (let j = 0; j < h; j++)
    for (let i = 0; i < w; i++) {
      const o = ((h - 1 - j) * w + i) * 4;
      image.data[o] = image.data[o + 1] = image.data[o + 2] = 128;
      image.data[o + 3] = 255 * (Math.log1p(plane.counts[j * w + i]) / top);
    }
  context.putImageData(image, 0, 0);
}
