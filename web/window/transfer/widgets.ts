// SPDX-License-Identifier: Apache-2.0
// Regions of the plane of value and second axis (Kniss et al. 2002), as the parameter `widgets` of a volume writes them:
// "triangle LO HI BASE TOP OPACITY COLOR; rectangle LO HI LOW HIGH OPACITY COLOR; ellipse LO HI LOW HIGH OPACITY COLOR;
// paint RADIUS:RADIUS VALUE,SECOND VALUE,SECOND OPACITY COLOR".
import { short } from "../words";

export const boxes = ["triangle", "rectangle", "ellipse"] as const;
export type Box = (typeof boxes)[number];

export interface Widget {
  shape: Box | "paint";
  low: number; // on the value's axis, as a value
  high: number;
  bottom: number; // on the second axis, 0 to 1: a triangle's tip, a rectangle's lower edge
  top: number;
  opacity: number;
  color: string; // "map": that of the value
  line?: [number, number][]; // of paint: where the brush went; its bounds are a radius farther out
  radius?: [number, number]; // of paint: a length on the value's axis, and a share of the second axis
}

/** The widget of a stroke. */
export function paint(line: [number, number][], radius: [number, number], opacity: number, color: string): Widget {
  const ends = (k: 0 | 1): [number, number] => [Math.min(...line.map((p) => p[k])) - radius[k], Math.max(...line.map((p) => p[k])) + radius[k]];
  const [[low, high], [bottom, top]] = [ends(0), ends(1)];
  return { shape: "paint", low, high, bottom, top, opacity, color, line, radius };
}

/** Null where the text is none of widgets. Places without @ are shares of the ranges; `second` is that of the second axis, if it is known. */
export function parseWidgets(text: string, range: [number, number], second: [number, number] | null = null): Widget[] | null {
  const value = (s: string | undefined): number => (s?.startsWith("@") ? number(s.slice(1)) : range[0] + number(s) * (range[1] - range[0]));
  const other = (s: string | undefined): number =>
    !s?.startsWith("@") ? number(s) : second && second[1] > second[0] ? (number(s.slice(1)) - second[0]) / (second[1] - second[0]) : NaN;
  const list: Widget[] = [];
  for (const part of text.split(";").map((s) => s.trim())) {
    if (part === "") continue;
    const words = part.split(/\s+/);
    const w = words[0] === "paint" ? parsePaint(words, range, second, value, other) : parseBox(words, value, other);
    if (!w || [w.low, w.high, w.bottom, w.top, w.opacity].some((x) => !Number.isFinite(x))) return null;
    list.push(w);
  }
  return list;
}

type Place = (s: string | undefined) => number;

const number = (s: string | undefined): number => (s === undefined || s === "" ? NaN : Number(s));

function parseBox(words: string[], value: Place, other: Place): Widget | null {
  const [shape, lo, hi, bottom, top, opacity = "1", color = "map"] = words;
  const known = boxes.find((b) => b === shape);
  return known && words.length <= 7 ? { shape: known, low: value(lo), high: value(hi), bottom: other(bottom), top: other(top), opacity: number(opacity), color } : null;
}

const isPair = (s: string): boolean => s.split(",").length === 2;

function parsePaint(words: string[], range: [number, number], second: [number, number] | null, value: Place, other: Place): Widget | null {
  const [along, up, ...more] = (words[1] ?? "").split(":");
  if (up === undefined || more.length > 0) return null;
  let end = 2;
  while (end < words.length && isPair(words[end])) end++;
  const line = words.slice(2, end).map((s): [number, number] => [value(s.split(",")[0]), other(s.split(",")[1])]);
  if (line.length === 0 || words.length > end + 2) return null;
  const rx = along.startsWith("@") ? number(along.slice(1)) : number(along) * Math.abs(range[1] - range[0]);
  const ry = up.startsWith("@") ? (second ? number(up.slice(1)) / (second[1] - second[0]) : NaN) : number(up);
  return rx > 0 && ry > 0 ? paint(line, [rx, ry], number(words[end] ?? "1"), words[end + 1] ?? "map") : null;
}

export const widgetsText = (list: Widget[]): string => list.map(widgetText).join("; ");

function widgetText(w: Widget): string {
  const where =
    w.line && w.radius
      ? `@${short(w.radius[0])}:${short(w.radius[1])} ${w.line.map(([v, s]) => `@${short(v)},${short(s)}`).join(" ")}`
      : `@${short(w.low)} @${short(w.high)} ${short(w.bottom)} ${short(w.top)}`;
  return `${w.shape} ${where} ${short(w.opacity)} ${w.color}`;
}

/** A widget over the middle of what is seen, to begin with. */
export function newWidget(shape: Box, range: [number, number], color: string): Widget {
  const at = (s: number): number => range[0] + s * (range[1] - range[0]);
  return { shape, low: at(0.35), high: at(0.65), bottom: shape === "triangle" ? 0 : 0.2, top: 0.6, opacity: 0.6, color };
}

/** The corners of a widget, or of the box round it, as shares of the plane. */
export function corners(w: Widget, range: [number, number]): [number, number][] {
  const x = (v: number): number => (v - range[0]) / (range[1] - range[0] || 1);
  if (w.shape !== "triangle")
    return [[x(w.low), w.bottom], [x(w.high), w.bottom], [x(w.high), w.top], [x(w.low), w.top]];
  return [[x((w.low + w.high) / 2), w.bottom], [x(w.high), w.top], [x(w.low), w.top]];
}

export type Grip = "body" | "low" | "high" | "top" | "bottom";

/** A widget after one of its grips was dragged by shares of the plane. A stroke has no grips but its body; the keys' "high" and "top" change
    its brush. */
export function gripped(w: Widget, grip: Grip, dx: number, dy: number, range: [number, number]): Widget {
  const dv = dx * (range[1] - range[0]);
  const clamp = (x: number): number => Math.max(0, Math.min(1, x));
  if (w.line && w.radius) {
    const least = 0.002;
    if (grip === "body") return paint(w.line.map(([v, s]) => [v + dv, s + dy]), w.radius, w.opacity, w.color);
    const wide = grip === "high" ? Math.max(w.radius[0] + dv / 2, least * Math.abs(range[1] - range[0])) : w.radius[0];
    return paint(w.line, [wide, grip === "top" ? Math.max(w.radius[1] + dy / 2, least) : w.radius[1]], w.opacity, w.color);
  }
  switch (grip) {
    case "body": {
      const up = Math.max(Math.min(0, -w.bottom), Math.min(Math.max(0, 1 - w.top), dy));
      return { ...w, low: w.low + dv, high: w.high + dv, bottom: w.bottom + up, top: w.top + up };
    }
    case "low":
      return { ...w, low: Math.min(w.low + dv, w.high) };
    case "high":
      return { ...w, high: Math.max(w.high + dv, w.low) };
    case "top":
      return { ...w, top: clamp(Math.max(w.top + dy, w.bottom + 0.01)) };
    case "bottom":
      return { ...w, bottom: clamp(Math.min(w.bottom + dy, w.top - 0.01)) };
  }
}
