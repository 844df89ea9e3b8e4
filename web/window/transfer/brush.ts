// SPDX-License-Identifier: Apache-2.0
// The brush that paints strokes over the plane of value and second axis. It is round as it is seen, and a stroke keeps as few points of
// its path as lie within a tenth of its radius, so that its words stay short.
import { paint, type Widget } from "./widgets";

type Point = [number, number];

/** What the command line takes for one stroke. */
export const mostPoints = 256;
const tolerance = 0.1; // radii

/** The radii of a brush whose size is a share of the plane's width; `shape` is its height as a multiple of its width. */
export const radiiOf = (size: number, range: Point, shape: number): Point => [rounded(size * Math.abs(range[1] - range[0]), range), Number((size / shape).toFixed(4))];

/** A stroke along shares of the plane. */
export function stroke(path: Point[], radius: Point, range: Point, opacity: number, color: string): Widget {
  const line = path.map(([x, y]): Point => [rounded(range[0] + x * (range[1] - range[0]), range), Number(y.toFixed(3))]);
  return paint(simplified(line, radius), radius, opacity, color);
}

/** A value to about a two thousandth of the range. */
function rounded(v: number, range: Point): number {
  const step = 10 ** Math.floor(Math.log10(Math.abs(range[1] - range[0]) / 2000));
  return step > 0 && Number.isFinite(step) ? Number((Math.round(v / step) * step).toPrecision(7)) : v;
}

/** Douglas and Peucker's selection of points, with distances in radii. */
export function simplified(line: Point[], radius: Point): Point[] {
  for (let allowed = tolerance; ; allowed *= 2) {
    const keep = new Array<boolean>(line.length).fill(false);
    keep[0] = keep[line.length - 1] = true;
    const open: Point[] = [[0, line.length - 1]];
    for (let part = open.pop(); part; part = open.pop()) {
      const [from, to] = part;
      let [farthest, most] = [-1, allowed];
      for (let i = from + 1; i < to; i++) {
        const off = distance(line[i], line[from], line[to], radius);
        if (off > most) [farthest, most] = [i, off];
      }
      if (farthest < 0) continue;
      keep[farthest] = true;
      open.push([from, farthest], [farthest, to]);
    }
    const kept = line.filter((_, i) => keep[i]).filter((p, i, all) => i === 0 || p[0] !== all[i - 1][0] || p[1] !== all[i - 1][1]);
    if (kept.length <= mostPoints) return kept;
  }
}

/** From a place to a straight line between two, in radii. */
export function distance(p: Point, a: Point, b: Point, radius: Point): number {
  const d = [(b[0] - a[0]) / radius[0], (b[1] - a[1]) / radius[1]];
  const q = [(p[0] - a[0]) / radius[0], (p[1] - a[1]) / radius[1]];
  const squared = d[0] * d[0] + d[1] * d[1];
  const t = squared > 0 ? Math.max(0, Math.min(1, (q[0] * d[0] + q[1] * d[1]) / squared)) : 0;
  return Math.hypot(q[0] - t * d[0], q[1] - t * d[1]);
}
