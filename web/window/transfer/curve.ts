// SPDX-License-Identifier: Apache-2.0
// The histogram with the opacity curve over it and the ends of the colours' range under it. Points are dragged, added by a double click
// or Insert, taken away by Delete or a double click on them, moved by arrow keys, and snap to round values and to the clicked one.
import { icon } from "../icons";
import { html, nothing, svg, type SVGTemplateResult, type TemplateResult } from "lit";
import type { App } from "../app";
import { beginDrag } from "../input/handle";
import type { Shown, Transfer } from "../protocol";
import { magnitude } from "../questions/probe";
import { plain, short } from "../words";
import { addPoint, movePoint, opacityText, parseOpacity, removePoint, roundValues, snap, type Point } from "./opacity";
import { axisOf, hull, share, valueAt, type Axis } from "./scale";

export const width = 340;
const height = 150;
const pad = { left: 10, right: 10, top: 10, bottom: 26 };
const inner = { w: width - pad.left - pad.right, h: height - pad.top - pad.bottom };

const ui = { log: true, point: -1 };

export interface Curve {
  app: App;
  index: number;
  shown: Shown;
  transfer: Transfer;
  axis: Axis;
  range: [number, number];
  points: Point[] | null; // null: this way to show has no opacity curve
}

export function curveOf(app: App, index: number): Curve | null {
  const shown = app.session.shown(index);
  const transfer = shown?.transfer;
  if (!shown || !transfer) return null;
  const at = `show/${index}`;
  const typed = app.session.edits.draft(at, "range")?.split(",").map(Number);
  const range = typed?.length === 2 && typed.every(Number.isFinite) ? (typed as [number, number]) : transfer.range;
  const axis = axisOf(hull(transfer.histogram?.range, range), app.session.word(at, "scale") ?? transfer.scale);
  const text = app.session.word(at, "opacity");
  const isCurve = shown.kind === "volume";
  const points = isCurve ? ((text !== undefined ? parseOpacity(text, range) : null) ?? transfer.opacity ?? [[range[0], 0], [range[1], 0.5]]) : null;
  return { app, index, shown, transfer, axis, range, points };
}

const x = (c: Curve, v: number): number => pad.left + Math.max(-0.02, Math.min(1.02, share(c.axis, v))) * inner.w;
const y = (o: number): number => pad.top + (1 - o) * inner.h;

export function curve(c: Curve): TemplateResult {
  const marked = c.app.probe.valueOf(c.transfer.field);
  const hovered = magnitude(c.app.probe.current?.answer.values?.find((v) => v.name === c.transfer.field)?.value ?? "none");
  const ticks = c.axis.log ? [c.axis.range[0], valueAt(c.axis, 0.5), c.axis.range[1]] : roundValues(c.axis.range, 5);
  return html`<div class="curve">
    <svg viewBox="0 0 ${width} ${height}" role="group" aria-label="Histogram and opacity of ${c.transfer.field}"
      @dblclick=${(e: MouseEvent) => doubleClick(c, e)} @keydown=${(e: KeyboardEvent) => key(c, e)}>
      <rect class="plot" x=${pad.left} y=${pad.top} width=${inner.w} height=${inner.h} />
      ${histogramPath(c)}
      ${ticks.map((t) => svg`<g class="tick"><line x1=${x(c, t)} x2=${x(c, t)} y1=${pad.top} y2=${pad.top + inner.h + 3} />
        <text x=${x(c, t)} y=${height - 4} text-anchor=${share(c.axis, t) < 0.06 ? "start" : share(c.axis, t) > 0.94 ? "end" : "middle"}>${plain(t)}</text></g>`)}
      ${rangeEnds(c)}
      ${c.points ? curvePath(c, c.points) : nothing}
      ${Number.isFinite(hovered) ? svg`<line class="hovered" x1=${x(c, hovered)} x2=${x(c, hovered)} y1=${pad.top} y2=${pad.top + inner.h} />` : nothing}
      ${marked !== null ? svg`<g class="marked"><line x1=${x(c, marked)} x2=${x(c, marked)} y1=${pad.top} y2=${pad.top + inner.h} />
        <path d="M${x(c, marked) - 4} ${pad.top - 7}h8l-4 6z" /></g>` : nothing}
    </svg>
    <div class="row">
      <div class="segmented" role="group" aria-label="Counts of the histogram">
        <button aria-pressed=${!ui.log ? "true" : "false"} @click=${() => setLog(c, false)}>linear</button>
        <button aria-pressed=${ui.log ? "true" : "false"} @click=${() => setLog(c, true)}>log</button>
      </div>
      <span class="grow"></span>
      ${c.points ? html`<button class="small" @click=${() => insert(c, marked)}>+ point${marked !== null ? ` at ${plain(marked)}` : ""}</button>` : nothing}
    </div>
    ${c.points ? table(c, c.points) : nothing}
  </div>`;
}

function setLog(c: Curve, log: boolean): void {
  ui.log = log;
  c.app.changed();
}

function histogramPath(c: Curve): SVGTemplateResult | typeof nothing {
  const h = c.transfer.histogram;
  if (!h || h.counts.length === 0) return nothing;
  const scale = (n: number): number => (ui.log ? Math.log1p(n) : n);
  const top = Math.max(...h.counts.map(scale), 1e-9);
  const width = (h.range[1] - h.range[0]) / h.counts.length;
  const bars = h.counts.map((n, i) => {
    const at = (v: number): string => x(c, v).toFixed(1);
    return `L${at(h.range[0] + i * width)} ${y(scale(n) / top).toFixed(1)}H${at(h.range[0] + (i + 1) * width)}`;
  });
  return svg`<path class="histogram" d="M${x(c, h.range[0])} ${y(0)}${bars.join("")}V${y(0)}Z" />`;
}

function setPoints(c: Curve, points: Point[], live: boolean): void {
  // A curve takes the place of widgets: the two exclude each other.
  const widgets = c.app.session.word(`show/${c.index}`, "widgets") !== undefined;
  c.app.session.set(`show/${c.index}`, { opacity: opacityText(points), ...(widgets ? { widgets: null } : {}) }, live);
}

function curvePath(c: Curve, points: Point[]): SVGTemplateResult {
  const path = points.map(([v, o]) => `${x(c, v).toFixed(1)} ${y(o).toFixed(1)}`).join("L");
  const left = `M${pad.left} ${y(points[0][1]).toFixed(1)}L`;
  const right = `H${pad.left + inner.w}`;
  return svg`<path class="opacity-fill" d="${left}${path}${right}V${y(0)}H${pad.left}Z" />
    <path class="opacity-line" d="${left}${path}${right}" />
    ${points.map(
      ([v, o], i) => svg`<g class="point ${i === ui.point ? "chosen" : ""}" tabindex="0" role="slider" data-index=${i}
        aria-label="Point ${i + 1} of ${points.length}" aria-valuenow=${o.toFixed(3)} aria-valuemin="0" aria-valuemax="1"
        aria-valuetext="opacity ${plain(o, 3)} at ${plain(v)}"
        @focus=${() => { if (ui.point !== i) { ui.point = i; c.app.changed(); } }}
        @pointerdown=${(e: PointerEvent) => dragPoint(c, points, i, e)}>
        <circle class="hit" cx=${x(c, v)} cy=${y(o)} r="11" /><circle class="dot" cx=${x(c, v)} cy=${y(o)} r="4.5" /></g>`,
    )}`;
}

/** From CSS pixels to units of the drawing. */
function unitOf(e: Event): number {
  const box = (e.currentTarget as Element).closest("svg")!.getBoundingClientRect();
  return width / box.width;
}

function dragPoint(c: Curve, points: Point[], i: number, e: PointerEvent): void {
  const k = unitOf(e);
  ui.point = i;
  c.app.changed();
  beginDrag(e, () => ({
    move: (dx, dy, done, m) => {
      const free = valueAt(c.axis, share(c.axis, points[i][0]) + (dx * k) / inner.w);
      const marked = c.app.probe.valueOf(c.transfer.field);
      const reach = ((c.axis.range[1] - c.axis.range[0]) * 5) / inner.w;
      const value = m.altKey ? free : snap(free, reach, [...roundValues(c.axis.range, 10), ...(marked === null ? [] : [marked])]);
      const opacity = Math.round((points[i][1] - (dy * k) / inner.h) * 200) / 200;
      setPoints(c, movePoint(points, i, m.shiftKey ? points[i][0] : value, opacity), !done);
    },
  }));
}

function doubleClick(c: Curve, e: MouseEvent): void {
  if (!c.points) return;
  const point = (e.target as Element).closest("[data-index]");
  if (point) return setPoints(c, removePoint(c.points, Number(point.getAttribute("data-index"))), false);
  const box = (e.currentTarget as Element).getBoundingClientRect();
  const k = width / box.width;
  const value = valueAt(c.axis, ((e.clientX - box.left) * k - pad.left) / inner.w);
  const opacity = 1 - ((e.clientY - box.top) * k - pad.top) / inner.h;
  const added = addPoint(c.points, value, opacity);
  ui.point = added.index;
  setPoints(c, added.points, false);
}

function insert(c: Curve, marked: number | null): void {
  if (!c.points) return;
  // Without a clicked value the point goes into the widest gap, where there is room to drag it.
  const gaps = c.points.slice(1).map((p, i) => [p[0] - c.points![i][0], (p[0] + c.points![i][0]) / 2]);
  const widest = gaps.sort((a, b) => b[0] - a[0])[0]?.[1] ?? c.points[0][0];
  const added = addPoint(c.points, marked ?? Number(short(widest)));
  ui.point = added.index;
  setPoints(c, added.points, false);
}

function key(c: Curve, e: KeyboardEvent): void {
  const at = (e.target as Element).closest("[data-index]");
  if (!c.points || !at) return;
  const i = Number(at.getAttribute("data-index"));
  const [v, o] = c.points[i];
  const fine = e.shiftKey ? 10 : 1;
  const dv = ((c.axis.range[1] - c.axis.range[0]) / 200) * fine;
  const moves: Record<string, () => Point[]> = {
    ArrowLeft: () => movePoint(c.points!, i, v - dv, o),
    ArrowRight: () => movePoint(c.points!, i, v + dv, o),
    ArrowUp: () => movePoint(c.points!, i, v, o + 0.01 * fine),
    ArrowDown: () => movePoint(c.points!, i, v, o - 0.01 * fine),
    Delete: () => removePoint(c.points!, i),
    Backspace: () => removePoint(c.points!, i),
    Insert: () => addPoint(c.points!, i + 1 < c.points!.length ? (v + c.points![i + 1][0]) / 2 : v).points,
  };
  const move = moves[e.key];
  if (!move) return;
  e.preventDefault();
  setPoints(c, move(), false);
}

function rangeEnds(c: Curve): SVGTemplateResult {
  const end = (k: 0 | 1): SVGTemplateResult => {
    const at = x(c, c.range[k]);
    const set = (value: number, live: boolean): void => {
      const r: [number, number] = [...c.range];
      r[k] = k === 0 ? Math.min(value, c.range[1]) : Math.max(value, c.range[0]);
      c.app.session.set(`show/${c.index}`, { range: r.map(short).join(",") }, live);
    };
    const base = pad.top + inner.h;
    return svg`<g class="range-end" tabindex="0" role="slider" aria-label=${k === 0 ? "Lower end of the colours" : "Upper end of the colours"}
      aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(100 * share(c.axis, c.range[k]))} aria-valuetext=${plain(c.range[k])}
      @pointerdown=${(e: PointerEvent) => {
        const scale = unitOf(e);
        beginDrag(e, () => ({ move: (dx, _dy, done) => set(valueAt(c.axis, share(c.axis, c.range[k]) + (dx * scale) / inner.w), !done) }));
      }}
      @keydown=${(e: KeyboardEvent) => {
        const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
        if (!by) return;
        e.preventDefault();
        set(c.range[k] + (by * (c.axis.range[1] - c.axis.range[0])) / 100, false);
      }}>
      <line x1=${at} x2=${at} y1=${pad.top} y2=${base} /><rect class="hit" x=${at - 10} y=${base - 8} width="20" height="22" />
      <path d="M${at} ${base}l5 8h-10z" /></g>`;
  };
  return svg`${end(0)}${end(1)}`;
}

/** The points as numbers to type. */
function table(c: Curve, points: Point[]): TemplateResult {
  const set = (i: number, k: 0 | 1, text: string): void => {
    const n = Number(text);
    if (text.trim() === "" || !Number.isFinite(n)) return c.app.changed();
    setPoints(c, k === 0 ? movePoint(points, i, n, points[i][1]) : movePoint(points, i, points[i][0], n), false);
  };
  return html`<details class="more"><summary>${points.length} points as numbers</summary>
    <table class="points"><thead><tr><th>value ${c.transfer.unit ?? ""}</th><th>opacity</th><th><span class="hidden">remove</span></th></tr></thead><tbody>
      ${points.map(
        ([v, o], i) => html`<tr class=${i === ui.point ? "chosen" : ""}>
          <td><input class="number" aria-label="Value of point ${i + 1}" .value=${short(v)} @change=${(e: Event) => set(i, 0, (e.target as HTMLInputElement).value)} /></td>
          <td><input class="number" aria-label="Opacity of point ${i + 1}" .value=${plain(o)} @change=${(e: Event) => set(i, 1, (e.target as HTMLInputElement).value)} /></td>
          <td><button class="icon small" aria-label="Remove point ${i + 1}" ?disabled=${points.length < 2} @click=${() => setPoints(c, removePoint(points, i), false)}>${icon("close")}</button></td></tr>`,
      )}
    </tbody></table></details>`;
}
