// SPDX-License-Identifier: Apache-2.0
// Opacity curves as text, as the command line takes them: "@-500:0,@200:0.4" by values, "0:0,0.3:0.1" by shares of the range.
import { short } from "../words";

export type Point = [value: number, opacity: number];

/** Points of a text, places as values of a range; null where it is not a curve. A single number is a constant opacity. */
export function parseOpacity(text: string, range: [number, number]): Point[] | null {
  const parts = text.split(",").map((s) => s.trim());
  if (parts.length === 1 && /^[\d.eE+-]+$/.test(parts[0])) {
    const o = Number(parts[0]);
    return Number.isFinite(o) ? [[range[0], o], [range[1], o]] : null;
  }
  const points: Point[] = [];
  for (const part of parts) {
    const m = /^(@?)([^:@]+):([^:]+)$/.exec(part);
    const place = m ? Number(m[2]) : NaN;
    const opacity = m ? Number(m[3]) : NaN;
    if (!m || !Number.isFinite(place) || !Number.isFinite(opacity) || opacity < 0 || opacity > 1) return null;
    const value = m[1] ? place : range[0] + place * (range[1] - range[0]);
    if (points.length > 0 && value < points[points.length - 1][0]) return null;
    points.push([value, opacity]);
  }
  return points.length > 0 ? points : null;
}

export const opacityText = (points: Point[]): string => points.map(([v, o]) => `@${short(v)}:${String(Number(o.toPrecision(4)))}`).join(",");

/** Opacity at a value: straight between the points, level beyond them. */
export function opacityAt(points: Point[], value: number): number {
  if (points.length === 0) return 0;
  if (value <= points[0][0]) return points[0][1];
  for (let i = 1; i < points.length; i++) {
    const [a, oa] = points[i - 1];
    const [b, ob] = points[i];
    if (value <= b) return b > a ? oa + ((ob - oa) * (value - a)) / (b - a) : ob;
  }
  return points[points.length - 1][1];
}

/** Moves a point; it stays between its neighbours. */
export function movePoint(points: Point[], index: number, value: number, opacity: number): Point[] {
  const low = index > 0 ? points[index - 1][0] : -Infinity;
  const high = index < points.length - 1 ? points[index + 1][0] : Infinity;
  const moved: Point = [Math.max(low, Math.min(high, value)), Math.max(0, Math.min(1, opacity))];
  return points.map((p, i) => (i === index ? moved : p));
}

/** Adds a point; returns the curve and the number of the new point. */
export function addPoint(points: Point[], value: number, opacity?: number): { points: Point[]; index: number } {
  const o = opacity ?? opacityAt(points, value);
  const index = points.filter((p) => p[0] <= value).length;
  return { points: [...points.slice(0, index), [value, Math.max(0, Math.min(1, o))], ...points.slice(index)], index };
}

export const removePoint = (points: Point[], index: number): Point[] => (points.length > 1 ? points.filter((_, i) => i !== index) : points);

/**
 * The nearest of the values that a point snaps to, if it is within `reach`: marks and round numbers of the axis, so that curves have
 * numbers one can say.
 */
export function snap(value: number, reach: number, marks: number[]): number {
  let best = value;
  let far = reach;
  for (const m of marks)
    if (Math.abs(m - value) <= far) {
      best = m;
      far = Math.abs(m - value);
    }
  return best;
}

/** Round numbers within a range: about `count` of them. */
export function roundValues([a, b]: [number, number], count: number): number[] {
  if (!(b > a)) return [a];
  const raw = (b - a) / count;
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999) ?? 10 * power;
  const first = Math.ceil(a / step - 1e-9);
  const last = Math.floor(b / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}
