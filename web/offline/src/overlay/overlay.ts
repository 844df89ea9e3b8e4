// SPDX-License-Identifier: Apache-2.0
// All that is written over the picture, in the order of importance of src/render/annotate/annotate.cpp.
import type { AnnotationInfo } from "../data/format";
import { cssOf } from "../data/srgb";
import type { Scale } from "../draw/scales";
import { type Bounds, type Projection, toPixel } from "../view/camera";
import { dot, type Vec3 } from "../view/vec";
import type { Curve } from "../volume/transfer";
import { drawAxes, drawTriad, triadPlace } from "./axes";
import { grown, type Layout, overlaps, type Rect } from "./layout";
import { drawLegend } from "./legends";
import { Pen } from "./pen";

export interface Annotated {
  annotation: AnnotationInfo;
  layout: Layout;
  projection: Projection;  // in pixels of the area
  box: Bounds | null;
  scales: Scale[];
  opacity: Curve | null;
  axes: boolean;
  moving: boolean;
}

/** Legends as they were last drawn: they are many rectangles, and stay while the picture turns. */
export class LegendCache {
  private readonly canvas = document.createElement("canvas");
  private of: unknown[] = [];
  private columns: Rect[] = [];

  draw(context: CanvasRenderingContext2D, v: Annotated): Rect[] {
    const { annotation: a, layout: at } = v, m = context.getTransform(), of = [a, at, v.opacity, m.a];
    if (of.some((x, i) => x !== this.of[i])) {
      this.of = of;
      this.canvas.width = context.canvas.width, this.canvas.height = context.canvas.height;
      const own = this.canvas.getContext("2d")!, pen = new Pen(own, a.dark);
      own.setTransform(m);
      this.columns = a.legends.map((l) => drawLegend(pen, l, a, at, v.scales, v.opacity));
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    if (a.legends.length) context.drawImage(this.canvas, 0, 0);
    context.setTransform(m);
    return this.columns.map((r) => ({ ...r }));
  }
}

export function drawOverlay(context: CanvasRenderingContext2D, v: Annotated, legends: LegendCache): void {
  const { annotation: a, layout: at, projection: p } = v, pen = new Pen(context, a.dark, v.moving), font = a.font * at.factor, { area } = at;
  const taken: Rect[] = [];
  if (a.title) {
    const size = a.title_size * at.factor, wrap = Math.max(1, at.width - 1.6 * font), e = pen.measure(a.title, { size, wrap });
    const r = { x: 0.5 * (at.width - e.width), y: a.title_box[1] * at.factor, width: e.width, height: e.height };
    pen.text(a.title, r.x, r.y, { size, wrap, centred: true, halo: true });
    taken.push(r);
  }
  for (const r of legends.draw(context, v)) taken.push(grown(r, 0.5 * font));
  // From here on in pixels of the picture beside the legends.
  for (const r of taken) r.x -= area.x, r.y -= area.y;
  context.save();
  context.translate(area.x, area.y);
  const triad = a.triad && v.axes;
  if (a.letters) drawLetters(pen, p, font, taken);
  if (triad) taken.push(triadPlace(p.height, font));
  if (a.caption) {
    const style = { size: font, wrap: Math.max(1, 0.55 * p.width), centred: true, halo: true }, e = pen.measure(a.caption, style);
    const whole = a.caption_height > 0, r = { x: 0.5 * (p.width - e.width), y: (whole ? at.height - area.y : p.height) - 0.6 * font - e.height, width: e.width, height: e.height };
    pen.text(a.caption, r.x, r.y, style);
    taken.push(grown(r, 0.3 * font));
  }
  if (a.scale_bar && v.box) drawScaleBar(pen, a, p, v.box, font, taken);
  drawNotes(pen, a, p, at, font, taken);
  if (v.axes) {
    drawTexts(pen, a, p, 0.88 * font, taken);
    if (v.box) drawAxes(pen, a, v.box, p, font, taken);
  }
  if (triad) drawTriad(pen, a, p, font);
  context.restore();
}

function drawTexts(pen: Pen, a: AnnotationInfo, p: Projection, font: number, taken: Rect[]): void {
  for (const t of a.texts) {
    const q = toPixel(p, t.at);
    if (!p.parallel && !(q[2] > 0)) continue;
    const d: Vec3 = [dot(t.along, p.right), dot(t.along, p.up), dot(t.along, p.forward)], ex = (q[0] - 0.5 * p.width) / p.scale, ey = (0.5 * p.height - q[1]) / p.scale;
    const x = p.parallel ? d[0] : d[0] - d[2] * ex, y = p.parallel ? d[1] : d[1] - d[2] * ey;
    let angle = x * x + y * y < 1e-6 * dot(t.along, t.along) || !(dot(t.along, t.along) > 0) ? 0 : Math.atan2(y, x);
    if (angle > Math.PI / 2 + 1e-9) angle -= Math.PI;
    else if (angle <= -Math.PI / 2 + 1e-9) angle += Math.PI;
    const size = font * t.size, e = pen.measure(t.text, { size }), n = Math.max(1, Math.ceil(e.width / e.height)), rects: Rect[] = [];
    for (let i = 0; i < n; ++i) {
      const along = n > 1 ? (i / (n - 1) - 0.5) * (e.width - e.height) : 0;
      rects.push({ x: q[0] + along * Math.cos(angle) - 0.5 * e.height, y: q[1] - along * Math.sin(angle) - 0.5 * e.height, width: e.height, height: e.height });
    }
    if (rects.some((r) => r.x < 1 || r.y < 1 || r.x + r.width > p.width - 1 || r.y + r.height > p.height - 1 || taken.some((o) => overlaps(o, r)))) continue;
    pen.turned(t.text, q[0], q[1], angle, { size, halo: true, color: t.color ? cssOf(t.color) : undefined });
    taken.push(...rects);
  }
}

function drawNotes(pen: Pen, a: AnnotationInfo, p: Projection, at: Layout, font: number, taken: Rect[]): void {
  for (const n of a.notes) {
    const size = font * n.size, style = { size, wrap: Math.max(1, 0.9 * at.width), halo: true, color: n.color ? cssOf(n.color) : undefined }, e = pen.measure(n.text, style), m = 0.6 * font;
    let x = 0.5 * (p.width - e.width), y = 0.5 * (p.height - e.height);
    if (n.at) x = n.at[0] * at.width - at.area.x - 0.5 * e.width, y = n.at[1] * at.height - at.area.y - 0.5 * e.height;
    else {
      if (n.place.includes("left")) x = m;
      if (n.place.includes("right")) x = p.width - e.width - m;
      if (n.place.includes("top")) y = m;
      if (n.place.includes("bottom")) y = p.height - e.height - m;
      const step = n.place.includes("bottom") ? -0.5 * font : 0.5 * font;
      for (let i = 0; i < 100 && taken.some((t) => overlaps(t, { x, y, width: e.width, height: e.height })); ++i) y += step;
    }
    pen.text(n.text, x, y, style);
    taken.push({ x, y, width: e.width, height: e.height });
  }
}

function drawScaleBar(pen: Pen, a: AnnotationInfo, p: Projection, box: Bounds, font: number, taken: Rect[]): void {
  const q = toPixel(p, [0, 1, 2].map((k) => 0.5 * (box.lo[k] + box.hi[k])) as Vec3), unit = p.parallel ? p.scale : p.scale / q[2];
  if (!(q[2] > 0 || p.parallel) || !(unit > 0)) return;
  const most = (0.22 * p.width) / unit, power = 10 ** Math.floor(Math.log10(most)), length = (most / power >= 5 ? 5 : most / power >= 2 ? 2 : 1) * power, pixels = length * unit;
  const text = `${Number(length.toPrecision(6))}${a.unit ? " " + a.unit : ""}`, e = pen.measure(text, { size: font }), thick = Math.max(2, 0.22 * font);
  const width = Math.max(e.width, pixels), height = e.height + 0.35 * font + thick, r = { x: p.width - 0.9 * font - width, y: p.height - 0.9 * font - height, width, height };
  const left = r.x + 0.5 * (width - pixels), y = r.y + r.height - 0.5 * thick;
  pen.line(left, y, left + pixels, y, thick);
  pen.text(text, r.x + 0.5 * (width - e.width), r.y, { size: font, halo: true });
  taken.push(grown(r, 0.3 * font));
}

/** World x, y, z of the patient frame: left, posterior, superior. */
function sideOf(d: Vec3): string {
  const names = [["R", "L"], ["A", "P"], ["I", "S"]];
  return [0, 1, 2].filter((k) => Math.abs(d[k]) >= 0.375).sort((x, y) => Math.abs(d[y]) - Math.abs(d[x])).map((k) => names[k][d[k] > 0 ? 1 : 0]).join("");
}

function drawLetters(pen: Pen, p: Projection, font: number, taken: Rect[]): void {
  const size = 1.25 * font, m = 0.6 * font, minus = (v: Vec3): Vec3 => [-v[0], -v[1], -v[2]];
  for (const [d, sx, sy] of [[minus(p.right), 0, 0.5], [p.right, 1, 0.5], [p.up, 0.5, 0], [minus(p.up), 0.5, 1]] as [Vec3, number, number][]) {
    const text = sideOf(d), e = pen.measure(text, { size, bold: true });
    const r = { x: m + sx * (p.width - e.width - 2 * m), y: m + sy * (p.height - e.height - 2 * m), width: e.width, height: e.height };
    if (taken.some((t) => overlaps(t, r))) continue;
    pen.text(text, r.x, r.y, { size, bold: true, halo: true });
    taken.push(grown(r, 0.5 * font));
  }
}
