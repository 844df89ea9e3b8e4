// SPDX-License-Identifier: Apache-2.0
// From opacity points and a colour scale to the tables that a ray reads.
import type { VolumeInfo } from "../data/format";
import type { Scale } from "../draw/scales";

export type Curve = [number, number][];

/** Straight lines between points, constant beyond them. */
export function opacityAt(points: Curve, v: number): number {
  if (points.length === 0 || !(v === v)) return 0;
  let after = 0;
  while (after < points.length && points[after][0] <= v) ++after;
  if (after === 0) return points[0][1];
  if (after === points.length) return points[after - 1][1];
  const [a, b] = [points[after - 1], points[after]];
  return a[1] + ((b[1] - a[1]) * (v - a[0])) / (b[0] - a[0]);
}
export function largestOpacity(points: Curve, lo: number, hi: number): number {
  let most = Math.max(opacityAt(points, lo), opacityAt(points, hi));
  for (const [v, o] of points) if (v >= lo && v <= hi) most = Math.max(most, o);
  return most;
}

export const tableSize = 4096;

export interface Tables {
  /** At even values of the lattice's codes: linear colour, and extinction per world length. */
  medium: Float32Array;
  /** Their integrals over the code from 0 on: colour times extinction, extinction. */
  sums: Float32Array;
  /** Of the same codes: 1 where something is drawn between them and the next. */
  seen: Uint8Array;
}

export function makeTables(info: VolumeInfo, scale: Scale, points: Curve): Tables {
  const n = tableSize, medium = new Float32Array(4 * n), sums = new Float32Array(4 * n), seen = new Uint8Array(n);
  const most = 12 / info.edge;  // hides what lies behind a cell
  const total = [0, 0, 0, 0];
  let last = [0, 0, 0, 0];
  for (let i = 0; i < n; ++i) {
    const value = info.least + ((info.most - info.least) * i) / (n - 1), c = scale.color(value);
    const opacity = c[3] > 0 ? Math.min(1, Math.max(0, opacityAt(points, value))) : 0;
    const tau = Math.min(most, -Math.log1p(-Math.min(opacity, 1 - 1e-12)) / info.unit);
    medium.set([c[0], c[1], c[2], tau], 4 * i);
    const now = [c[0] * tau, c[1] * tau, c[2] * tau, tau];
    if (i > 0) for (let k = 0; k < 4; ++k) total[k] += (0.5 * (last[k] + now[k])) / (n - 1);
    sums.set(total, 4 * i);
    if (tau > 0) seen[i] = 1;
    last = now;
  }
  // A peak between two codes.
  for (const [v, o] of points) {
    const at = Math.floor(((v - info.least) / (info.most - info.least)) * (n - 1));
    if (o > 0) for (const i of [at, at + 1]) if (i >= 0 && i < n) seen[i] = 1;
  }
  return { medium, sums, seen };
}

/** For every code below `n` how many of seen[0..i) are set. */
export function countsOf(seen: Uint8Array): Uint32Array {
  const counts = new Uint32Array(seen.length + 1);
  for (let i = 0; i < seen.length; ++i) counts[i + 1] = counts[i] + seen[i];
  return counts;
}
