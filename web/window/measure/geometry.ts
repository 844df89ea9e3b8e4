// SPDX-License-Identifier: Apache-2.0
// What places of the data measure: distances, angles and areas.
import { add, cross, dot, length, scale, sub } from "../camera/vector";
import type { Vec3 } from "../protocol";

export interface Measured {
  what: "distance" | "angle" | "area" | "length";
  value: number; // in units of length, degrees, squares of units of length
}

/** Angle at b between a and c, in degrees; 0 where two of them coincide. */
export function angleAt(a: Vec3, b: Vec3, c: Vec3): number {
  const u = sub(a, b);
  const v = sub(c, b);
  // By both sine and cosine: exact for small and for flat angles, too.
  return (Math.atan2(length(cross(u, v)), dot(u, v)) * 180) / Math.PI;
}

export const lengthAlong = (points: Vec3[]): number => points.slice(1).reduce((sum, p, i) => sum + length(sub(p, points[i])), 0);

const middle = (points: Vec3[]): Vec3 => scale(points.reduce(add, [0, 0, 0] as Vec3), 1 / Math.max(points.length, 1));

/** Newell's normal of the closed polygon: as long as its area. */
export function areaNormal(points: Vec3[]): Vec3 {
  const c = middle(points);
  let sum: Vec3 = [0, 0, 0];
  points.forEach((p, i) => (sum = add(sum, cross(sub(p, c), sub(points[(i + 1) % points.length], c)))));
  return scale(sum, 0.5);
}

/** The largest distance of a corner from the polygon's plane, as a share of how far corners lie apart. */
export function unevenness(points: Vec3[]): number {
  const c = middle(points);
  const n = areaNormal(points);
  const reach = 2 * Math.max(0, ...points.map((p) => length(sub(p, c))));
  if (!(length(n) > 0) || !(reach > 0)) return 0;
  return Math.max(...points.map((p) => Math.abs(dot(sub(p, c), n)))) / length(n) / reach;
}

/** Above this the area is of no surface through the corners. */
export const mostUneven = 0.01;

/** Two places have a distance, three an angle at the middle one and an area, more a length along and the area within. */
export function measured(points: Vec3[]): Measured[] {
  if (points.length < 2) return [];
  if (points.length === 2) return [{ what: "distance", value: lengthAlong(points) }];
  const area: Measured = { what: "area", value: length(areaNormal(points)) };
  if (points.length === 3) return [{ what: "angle", value: angleAt(points[0], points[1], points[2]) }, area];
  return [{ what: "length", value: lengthAlong(points) }, area];
}

/** An outline with fewer corners, none of which was farther than `tolerance` from what is left (Douglas and Peucker 1973). */
export function simplified(points: [number, number][], tolerance: number): [number, number][] {
  if (points.length < 3) return points;
  const keep = new Uint8Array(points.length);
  keep[0] = keep[points.length - 1] = 1;
  const ranges: [number, number][] = [[0, points.length - 1]];
  for (let range = ranges.pop(); range; range = ranges.pop()) {
    const [a, b] = range;
    let farthest = tolerance;
    let at = -1;
    for (let i = a + 1; i < b; i++) {
      const d = fromSegment(points[i], points[a], points[b]);
      if (d > farthest) [farthest, at] = [d, i];
    }
    if (at < 0) continue;
    keep[at] = 1;
    ranges.push([a, at], [at, b]);
  }
  return points.filter((_, i) => keep[i]);
}

function fromSegment(p: [number, number], a: [number, number], b: [number, number]): number {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const square = dx * dx + dy * dy;
  const t = square > 0 ? Math.min(1, Math.max(0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square)) : 0;
  return Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}
