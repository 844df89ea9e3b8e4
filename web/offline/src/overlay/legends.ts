// SPDX-License-Identifier: Apache-2.0
// Legends: places of src/render/annotate/legend, moved and grown with the window. The bar has exactly the colours of the picture's.
import type { AnnotationInfo, Box, LegendInfo, Rgba } from "../data/format";
import { cssColor, encodeSrgb } from "../data/srgb";
import type { Scale } from "../draw/scales";
import { type Curve, largestOpacity, opacityAt } from "../volume/transfer";
import type { Layout, Rect } from "./layout";
import type { Pen } from "./pen";

/** From the stated picture's pixels to the window's. */
class Place {
  constructor(private readonly l: LegendInfo, private readonly a: AnnotationInfo, private readonly at: Layout) {}
  x(x: number): number {
    const { factor: f, width } = this.at;
    if (this.l.place === "right") return width - (this.a.width - x) * f;
    if (this.l.place === "left") return x * f;
    return 0.5 * width + (x - 0.5 * this.a.width) * f;
  }
  y(y: number): number {
    const { factor: f, height } = this.at;
    if (this.l.place === "top") return y * f;
    if (this.l.place === "bottom") return height - (this.a.height - y) * f;
    return 0.5 * height + (y - 0.5 * this.a.height) * f;
  }
  rect(b: Box): Rect {
    const x = Math.round(this.x(b[0])), y = Math.round(this.y(b[1])), f = this.at.factor;
    return { x, y, width: Math.round(b[2] * f), height: Math.round(b[3] * f) };
  }
  length(v: number): number {
    return v * this.at.factor;
  }
}

const fill = (c: CanvasRenderingContext2D, color: ArrayLike<number>, x: number, y: number, w: number, h: number) => {
  if (color[3] === 0) return;
  c.fillStyle = cssColor(color);
  c.fillRect(x, y, w, h);
};

export function drawLegend(pen: Pen, l: LegendInfo, a: AnnotationInfo, at: Layout, scales: Scale[], opacity: Curve | null): Rect {
  const p = new Place(l, a, at), font = p.length(l.font);
  if (l.title) {
    const style = { size: p.length(l.title_size), wrap: p.length(l.title_wrap), centred: l.title_centred };
    if (l.title_upwards) {
      const [w, h] = l.title_extent;
      pen.turned(l.title, p.x(l.title_at[0] + 0.5 * h), p.y(l.title_at[1] + 0.5 * w), Math.PI / 2, { ...style, halo: true });
    } else pen.text(l.title, p.x(l.title_at[0]), p.y(l.title_at[1]), { ...style, halo: true });
  }
  if (l.colors) drawBar(pen, l, p, font);
  else drawNames(pen, l, p, font);
  if (l.panel && l.scale !== undefined) drawPanel(pen, l, p, font, scales[l.scale], opacity ?? l.opacity ?? []);
  if (l.glyph) drawGlyph(pen, l, p, font);
  if (l.nan) {
    const x = Math.round(p.x(l.nan_at[0])), y = Math.round(p.y(l.nan_at[1])), side = Math.round(1.3 * font);
    fill(pen.context, l.nan_color, x, y, side, Math.round(0.9 * font));
    pen.frame(x, y, side, Math.round(0.9 * font));
    pen.text("NaN", x + side + 0.75 * font, y - 0.15 * font, { size: font, halo: true });
  }
  return p.rect(l.column);
}

function drawBar(pen: Pen, l: LegendInfo, p: Place, font: number): void {
  const c = pen.context, r = p.rect(l.bar), colors = l.colors!, lies = l.place === "top" || l.place === "bottom";
  const n = lies ? r.width : r.height, there = colors.length / 4;
  for (let i = 0; i < n; ++i) {
    const k = 4 * Math.min(there - 1, n === there ? i : Math.round((i / Math.max(1, n - 1)) * (there - 1)));
    const color = colors.slice(k, k + 4);
    if (lies) fill(c, color, r.x + i, r.y, 1, r.height);
    else fill(c, color, r.x, r.y + i, r.width, 1);
  }
  pen.frame(r.x, r.y, r.width, r.height);
  const right = r.x + r.width, bottom = r.y + r.height, tip = font, mx = r.x + 0.5 * r.width, my = r.y + 0.5 * r.height;
  if (l.above) pen.polygon(lies ? [[right + 2, r.y], [right + 2 + tip, my], [right + 2, bottom]] : [[r.x, r.y - 2], [mx, r.y - 2 - tip], [right, r.y - 2]], cssColor(l.above), true);
  if (l.below) pen.polygon(lies ? [[r.x - 2, r.y], [r.x - 2 - tip, my], [r.x - 2, bottom]] : [[r.x, bottom + 2], [mx, bottom + 2 + tip], [right, bottom + 2]], cssColor(l.below), true);
  const thick = Math.max(1, 0.07 * font), half = 0.5 * pen.measure("0", { size: font }).height, [bx, by] = [l.bar[0], l.bar[1]], last = Math.max(1, there - 1);
  for (const t of l.ticks) {
    const share = (t.at - (lies ? bx : by)) / last, place = (lies ? r.x : r.y) + Math.round(share * (n - 1)) + 0.5;
    if (lies) {
      pen.line(place, bottom, place, bottom + 0.35 * font, thick, pen.ink, 0.9);
      pen.text(t.text, place - 0.5 * pen.measure(t.text, { size: font }).width, bottom + 0.45 * font, { size: font, halo: true });
    } else {
      pen.line(right, place, right + 0.35 * font, place, thick, pen.ink, 0.9);
      pen.text(t.text, right + 0.75 * font, place - half, { size: font, halo: true });
    }
  }
}

function drawNames(pen: Pen, l: LegendInfo, p: Place, font: number): void {
  const r = p.rect(l.bar), row = p.length(l.row_height), wide = p.length(l.row_width), side = Math.round(1.3 * font);
  l.rows.forEach((name, i) => {
    const x = r.x + (i % l.across) * wide, y = r.y + Math.floor(i / l.across) * row;
    if (i < l.swatches.length) {
      const top = Math.round(y + 0.12 * row), high = Math.round(0.76 * row);
      fill(pen.context, l.swatches[i], Math.round(x), top, side, high);
      pen.frame(Math.round(x), top, side, high);
    }
    pen.text(name, x + (i < l.swatches.length ? side + 0.6 * font : 0), y + 0.5 * (row - 1.164 * font), { size: font, halo: true, wrap: 12 * font, cut: true });
  });
}

/** Opacity over the bar, filled with the colours. */
function drawPanel(pen: Pen, l: LegendInfo, p: Place, font: number, scale: Scale, points: Curve): void {
  const c = pen.context, r = p.rect(l.panel!), lies = l.place === "top" || l.place === "bottom", n = lies ? r.width : r.height, across = lies ? r.height : r.width;
  const s = scale.info, most = largestOpacity(points, s.lo, s.hi) || 1, tile = Math.max(2, Math.round(0.4 * font));
  for (let j = 0; j < r.height; j += tile)
    for (let i = 0; i < r.width; i += tile) {
      const g = (i / tile + j / tile) % 2 ? 219 : 255;
      fill(c, [g, g, g, 255], r.x + i, r.y + j, Math.min(tile, r.width - i), Math.min(tile, r.height - j));
    }
  let before = -1;
  const thick = Math.max(1, Math.round(0.08 * font));
  for (let i = 0; i < n; ++i) {
    const v = scale.value(lies ? i / Math.max(1, n - 1) : 1 - i / Math.max(1, n - 1)), o = opacityAt(points, v), reach = Math.min(across - 1, Math.max(0, Math.round((o / most) * (across - 1))));
    const color: Rgba = [...Array.from(scale.color(v)).slice(0, 3).map((x) => Math.round(255 * encodeSrgb(x))), 255] as Rgba;
    const from = Math.max(0, Math.min(reach, before < 0 ? reach : before) - thick + 1), to = Math.max(reach, before);
    if (lies) {
      fill(c, color, r.x + i, r.y + across - reach, 1, reach);
      fill(c, [26, 26, 31, 255], r.x + i, r.y + across - 1 - to, 1, to - from + 1);
    } else {
      fill(c, color, r.x, r.y + i, reach, 1);
      fill(c, [26, 26, 31, 255], r.x + from, r.y + i, to - from + 1, 1);
    }
    before = reach;
  }
  pen.frame(r.x, r.y, r.width, r.height);
  const [low, , caption] = l.panel_texts!, size = 0.78 * font, line = pen.measure("0", { size }).height;
  const high = String(Number(most.toPrecision(2)));
  if (lies) {
    const x = r.x + r.width + 0.5 * font;
    pen.text(high, x, r.y - 0.15 * line, { size, halo: true }), pen.text(low, x, r.y + r.height - 0.85 * line, { size, halo: true });
    pen.text(caption, x, r.y + 0.5 * (r.height - line), { size, halo: true });
    return;
  }
  const y = r.y + r.height + 0.25 * font;
  pen.text(low, r.x, y, { size, halo: true });
  pen.text(high, r.x + r.width - pen.measure(high, { size }).width, y, { size, halo: true });
  const width = Math.min(r.width, pen.measure(caption, { size }).width);
  pen.text(caption, r.x + 0.5 * (r.width - width), y + 0.95 * line, { size, halo: true });
}

function drawGlyph(pen: Pen, l: LegendInfo, p: Place, font: number): void {
  const g = p.rect(l.glyph!), y = g.y + 0.5 * g.height, color = cssColor(l.glyph_color!), size = p.length(l.glyph![2]);
  if (l.glyph_arrow) {
    const tip = Math.min(0.9 * font, 0.4 * size), half = 0.4 * tip, shaft = Math.max(0.5, 0.12 * tip), neck = g.x + size - tip;
    pen.polygon([[g.x, y - shaft], [neck, y - shaft], [neck, y - half], [g.x + size, y], [neck, y + half], [neck, y + shaft], [g.x, y + shaft]], color, true);
  } else {
    const r = 0.5 * Math.min(size, g.height);
    pen.polygon(Array.from({ length: 32 }, (_, k) => [g.x + r + r * Math.cos(k * 0.19634954), y + r * Math.sin(k * 0.19634954)] as [number, number]), color, true);
  }
  pen.text("= " + (l.glyph_text ?? ""), g.x + size + 0.6 * font, y - 0.58 * font, { size: font, halo: true });
}
