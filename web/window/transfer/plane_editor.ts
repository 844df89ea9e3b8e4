// SPDX-License-Identifier: Apache-2.0
// Two-dimensional transfer functions: widgets over the histogram of value and second axis, and the brush that paints more of them.
import { icon } from "../icons";
import { html, nothing, svg, type SVGTemplateResult, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { ref } from "lit/directives/ref.js";
import type { PlaneAnswer } from "../protocol";
import { plain } from "../words";
import { hexOf } from "../controls/color_text";
import { width, type Curve } from "./curve";
import { paintArea, type Painting } from "./paint_area";
import { widgetShape } from "./widget_shape";
import { boxes, newWidget, paint, parseWidgets, widgetsText, type Box, type Widget } from "./widgets";

const height = 170;
const ui = { chosen: 0, painting: { on: false, size: 0.04, at: [0.5, 0.3], open: false } as Painting };
const palette = ["tomato", "gold", "mediumseagreen", "steelblue", "orchid"];

type Set = (next: Widget[], live?: boolean) => void;

export function planeEditor(c: Curve): TemplateResult {
  const at = `show/${c.index}`;
  const counts = c.app.histograms.plane(c.index);
  const now = (): Widget[] | null => parseWidgets(c.app.session.word(at, "widgets") ?? "", c.range, counts?.second ?? null);
  const read = now();
  const list = read ?? [];
  const problem = c.app.session.edits.problem(at, "widgets");
  // Widgets take the place of a curve: the two exclude each other. All edits of a drag set the same words, so that they are one step.
  const set: Set = (next, live = false) => c.app.session.set(at, next.length > 0 ? { widgets: widgetsText(next), opacity: null } : { widgets: null }, live);
  const color = (): string => palette[list.length % palette.length];
  const add = (shape: Box): void => {
    ui.chosen = list.length;
    ui.painting.on = false;
    set([...list, newWidget(shape, c.range, color())]);
  };
  const choose = (i: number): void => {
    if (ui.chosen === i) return;
    ui.chosen = i;
    c.app.changed();
  };
  // What is painted is chosen.
  const drawn: Set = (next, live) => {
    ui.chosen = next.length - 1;
    set(next, live);
  };
  const axis = (c.app.session.word(at, "second") ?? "gradient").replaceAll("_", " ");
  const w = list[ui.chosen];
  const painting = (): void => {
    ui.painting.on = !ui.painting.on;
    c.app.changed();
  };
  return html`<div class="plane">
    <div class="plane-box">
      <canvas class="plane-counts" aria-hidden="true" ${ref((e) => e && drawCounts(e as HTMLCanvasElement, counts, c.range))}></canvas>
      <svg viewBox="0 0 ${width} ${height}" role="group" aria-label="Widgets over value (to the right) and ${axis} (upwards)">
        ${list.map((x, i) =>
          widgetShape(
            {
              range: c.range,
              size: [width, height],
              chosen: i === ui.chosen,
              choose: () => choose(i),
              now: () => now()?.[i] ?? x,
              put: (next, live) => set(list.map((y, k) => (k === i ? next : y)), live),
              remove: () => set(list.filter((_, k) => k !== i)),
            },
            x,
          ),
        )}
        ${mark(c, counts)}
        ${ui.painting.on ? paintArea({ painting: ui.painting, range: c.range, size: [width, height], axis, color: color(), changed: () => c.app.changed(), list: () => now() ?? [], set: drawn }) : nothing}
      </svg>
    </div>
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    ${read ? nothing : html`<p class="quiet">The widgets are written in a way that is not drawn here; new ones take their place.</p>`}
    <p class="quiet axis-names"><span>${plain(c.range[0])}</span><span>value → · ${axis} ↑</span><span>${plain(c.range[1])}</span></p>
    <div class="row wrap">
      ${boxes.map((shape) => html`<button class="small" @click=${() => add(shape)}>+ ${shape}</button>`)}
      <button class="small" aria-pressed=${ui.painting.on ? "true" : "false"} @click=${painting}>paint</button>
      ${list.length > 0 ? html`<button class="small" @click=${() => set([])}>Remove all</button>` : nothing}
    </div>
    ${ui.painting.on ? brushSize(c) : nothing}
    ${w ? details(c, list, w, set) : html`<p class="quiet">Widgets pick out materials and their borders; they replace the opacity curve.</p>`}
  </div>`;
}

/** The value that was clicked in the picture, and with what stands on the second axis there the place in the plane. */
function mark(c: Curve, counts: PlaneAnswer | null): SVGTemplateResult | typeof nothing {
  const place = c.app.histograms.placeInPlane(c.index);
  const value = place?.[0] ?? c.app.probe.valueOf(c.transfer.field);
  const across = value === null ? NaN : (value - c.range[0]) / (c.range[1] - c.range[0]);
  if (!(across >= 0 && across <= 1)) return nothing;
  const x = across * width;
  const up = place && counts ? (place[1] - counts.second[0]) / (counts.second[1] - counts.second[0] || 1) : NaN;
  // What is steeper than the plane is high stands at its upper edge.
  const y = (1 - Math.min(1, up)) * height;
  return svg`<g class="marked"><line x1=${x} x2=${x} y1="0" y2=${height} /><path d="M${x - 4} 0h8l-4 6z" />
    ${up >= 0 ? svg`<circle cx=${x} cy=${y} r="4.5"><title>The place that was clicked</title></circle>` : nothing}</g>`;
}

function brushSize(c: Curve): TemplateResult {
  const resize = (e: Event): void => {
    ui.painting.size = Number((e.target as HTMLInputElement).value);
    c.app.changed();
  };
  return html`<div class="row"><label class="grow row">brush <input class="grow" type="range" min="0.01" max="0.2" step="0.005" .value=${live(String(ui.painting.size))} aria-label="Radius of the brush" @input=${resize} /></label></div>`;
}

function details(c: Curve, list: Widget[], w: Widget, set: Set): TemplateResult {
  const change = (part: Partial<Widget>, live: boolean): void => set(list.map((x, i) => (i === ui.chosen ? { ...x, ...part } : x)), live);
  const picked = (e: Event, live: boolean): void => change({ color: (e.target as HTMLInputElement).value }, live);
  const faded = (e: Event, live: boolean): void => change({ opacity: Number((e.target as HTMLInputElement).value) }, live);
  // Of a stroke: its brush, with the same proportions.
  const span = Math.abs(c.range[1] - c.range[0]) || 1;
  const widened = (e: Event, live: boolean): void => {
    const by = (Number((e.target as HTMLInputElement).value) * span) / w.radius![0];
    change(paint(w.line!, [w.radius![0] * by, w.radius![1] * by], w.opacity, w.color), live);
  };
  return html`<div class="row">
    <input type="color" aria-label="Colour of the widget" .value=${hexOf(w.color === "map" ? "" : w.color)} @input=${(e: Event) => picked(e, true)} @change=${(e: Event) => picked(e, false)} />
    <label class="grow row">opacity <input class="grow" type="range" min="0" max="1" step="0.01" .value=${String(w.opacity)} aria-label="Opacity of the widget"
      @input=${(e: Event) => faded(e, true)} @change=${(e: Event) => faded(e, false)} /></label>
    <button class="small" aria-pressed=${w.color === "map" ? "true" : "false"} @click=${() => change({ color: w.color === "map" ? "tomato" : "map" }, false)}>map's colour</button>
    <button class="icon small" aria-label="Remove the widget" @click=${() => set(list.filter((_, i) => i !== ui.chosen))}>${icon("close")}</button>
  </div>
  ${w.radius ? html`<div class="row"><label class="grow row">radius <input class="grow" type="range" min="0.01" max="0.2" step="0.005" .value=${String(w.radius[0] / span)} aria-label="Radius of the stroke"
      @input=${(e: Event) => widened(e, true)} @change=${(e: Event) => widened(e, false)} /></label></div>` : nothing}`;
}

/** The counts as greys, logarithmically: few voxels of a border must be seen beside millions of air. */
function drawCounts(canvas: HTMLCanvasElement, plane: PlaneAnswer | null, range: [number, number]): void {
  const key = plane ? `${plane.n} ${range}` : "none";
  if (canvas.dataset.key === key) return;
  canvas.dataset.key = key;
  if (!plane) return;
  const [w, h] = plane.size;
  canvas.width = w;
  canvas.height = h;
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(w, h);
  const top = Math.log1p(Math.max(...plane.counts, 1));
  const [lo, hi] = plane.value;
  for (let i = 0; i < w; i++) {
    // The counts are over all values, the drawing over the range of the colours.
    const column = Math.floor(((range[0] + ((i + 0.5) / w) * (range[1] - range[0]) - lo) / (hi - lo || 1)) * w);
    for (let j = 0; j < h; j++) {
      const o = ((h - 1 - j) * w + i) * 4;
      image.data[o] = image.data[o + 1] = image.data[o + 2] = 128;
      image.data[o + 3] = column >= 0 && column < w ? 255 * (Math.log1p(plane.counts[j * w + column]) / top) : 0;
    }
  }
  context.putImageData(image, 0, 0);
}
