// SPDX-License-Identifier: Apache-2.0
// Regions of the plane of value and second axis (Kniss et al. 2002), as the parameter `widgets` of a volume writes them:
// "triangle LO HI BASE TOP OPACITY COLOR; rectangle LO HI LOW HIGH OPACITY COLOR".
import { short } from "../words";

export interface Widget {
  shape: "triangle" | "rectangle";
  low: number; // on the value's axis, as a value
  high: number;
  bottom: number; // on the second axis, 0 to 1: a triangle's tip, a rectangle's lower edge
  top: number;
  opacity: number;
  color: string; // "map": that of the value
}

/** Null where the text is none of widgets. Places without @ are shares of the range. */
export function parseWidgets(text: string, range: [number, number]): Widget[] | null {
  const list: Widget[] = [];
  for (const part of text.split(";").map((s) => s.trim())) {
    if (part === "") continue;
    const [shape, lo, hi, bottom, top, opacity = "1", color = "map"] = part.split(/\s+/);
    const place = (s: string | undefined): number => (s?.startsWith("@") ? Number(s.slice(1)) : range[0] + Number(s) * (range[1] - range[0]));
    const w = { shape, low: place(lo), high: place(hi), bottom: Number(bottom), top: Number(top), opacity: Number(opacity), color };
    if ((shape !== "triangle" && shape !== "rectangle") || [w.low, w.high, w.bottom, w.top, w.opacity].some((x) => !Number.isFinite(x))) return null;
    list.push(w as Widget);
  }
  return list;
}

export const widgetsText = (list: Widget[]): string =>
  list
    .map((w) => `${w.shape} @${short(w.low)} @${short(w.high)} ${short(w.bottom)} ${short(w.top)} ${short(w.opacity)} ${w.color}`)
    .join("; ");

/** A widget over the middle of what is seen, to begin with. */
export function newWidget(shape: Widget["shape"], range: [number, number], color: string): Widget {
  const at = (s: number): number => range[0] + s * (range[1] - range[0]);
  return { shape, low: at(0.35), high: at(0.65), bottom: shape === "triangle" ? 0 : 0.2, top: 0.6, opacity: 0.6, color };
}

/** The corners of a widget as shares of the plane. */
export function corners(w: Widget, range: [number, number]): [number, number][] {
  const x = (v: number): number => (v - range[0]) / (range[1] - range[0] || 1);
  if (w.shape === "rectangle")
    return [[x(w.low), w.bottom], [x(w.high), w.bottom], [x(w.high), w.top], [x(w.low), w.top]];
  return [[x((w.low + w.high) / 2), w.bottom], [x(w.high), w.top], [x(w.low), w.top]];
}

export type Grip = "body" | "low" | "high" | "top" | "bottom";

/** A widget after one of its grips was dragged by shares of the plane. */
export function gripped(w: Widget, grip: Grip, dx: number, dy: number, range: [number, number]): Widget {
  const dv = dx * (range[1] - range[0]);
  const clamp = (x: number): number => Math.max(0, Math.min(1, x));
  switch (grip) {
    case "body": {
      const up = Math.max(-w.bottom, Math.min(1 - w.top, dy));
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
