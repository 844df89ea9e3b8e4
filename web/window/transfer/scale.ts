// SPDX-License-Identifier: Apache-2.0
// Values to shares of an axis and back, linear or logarithmic as the colours are.

export interface Axis {
  range: [number, number];
  log: boolean;
}

export function axisOf(range: [number, number], scale: string): Axis {
  return { range, log: scale === "log" && range[0] > 0 };
}

export function share(axis: Axis, value: number): number {
  const [a, b] = axis.range;
  if (!(b > a)) return 0.5;
  return axis.log ? Math.log(Math.max(value, a * 1e-6) / a) / Math.log(b / a) : (value - a) / (b - a);
}

export function valueAt(axis: Axis, s: number): number {
  const [a, b] = axis.range;
  return axis.log ? a * Math.pow(b / a, s) : a + s * (b - a);
}

/** The range of an axis that shows the whole data and the colours' range. */
export function hull(...ranges: ([number, number] | undefined)[]): [number, number] {
  const all = ranges.filter((r): r is [number, number] => r !== undefined && Number.isFinite(r[0]) && Number.isFinite(r[1]));
  if (all.length === 0) return [0, 1];
  return [Math.min(...all.map((r) => r[0])), Math.max(...all.map((r) => r[1]))];
}
