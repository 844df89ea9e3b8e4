// SPDX-License-Identifier: Apache-2.0
// Whole numbers of few bits back to what they stand for (src/pipeline/offline/pack/quantize.cpp).
import type { ArrayStore, Numbers } from "./arrays";
import type { NormalsInfo, PositionsInfo, Triple } from "./format";

/** Places less `center`, as floats. */
export async function positionsOf(p: PositionsInfo, center: Triple, store: ArrayStore): Promise<Float32Array> {
  const codes = await store.get(p.array);
  const out = new Float32Array(codes.length), most = 2 ** p.bits - 1;
  const from = [0, 1, 2].map((a) => p.origin[a] - center[a] + p.lo[a]), per = p.size.map((s) => s / most);
  for (let i = 0; i < codes.length; ++i) out[i] = from[i % 3] + per[i % 3] * codes[i];
  return out;
}

export async function normalsOf(n: NormalsInfo, store: ArrayStore): Promise<Float32Array> {
  const codes = await store.get(n.array), most = 2 ** n.bits - 1;
  const out = new Float32Array((codes.length / 2) * 3);
  for (let i = 0; i < codes.length / 2; ++i) {
    let u = (2 * codes[2 * i]) / most - 1, v = (2 * codes[2 * i + 1]) / most - 1;
    const z = 1 - Math.abs(u) - Math.abs(v);
    if (z < 0) {
      const w = (1 - Math.abs(v)) * (u < 0 ? -1 : 1);
      v = (1 - Math.abs(u)) * (v < 0 ? -1 : 1);
      u = w;
    }
    const l = Math.hypot(u, v, z) || 1;
    out[3 * i] = u / l, out[3 * i + 1] = v / l, out[3 * i + 2] = z / l;
  }
  return out;
}

/** Positions on a scale; NaN where there is no value. */
export function scalePositions(codes: Numbers, bits: number, least: number, most: number): Float64Array {
  const all = 2 ** bits - 1, first = 2 ** bits / 16, last = all - first;
  const out = new Float64Array(codes.length);
  for (let i = 0; i < codes.length; ++i) {
    const c = codes[i];
    out[i] = c === 0 ? NaN
      : c < first ? least - (least * (c - 1)) / (first - 1)
      : c <= last ? (c - first) / (last - first)
      : 1 + ((most - 1) * (c - last)) / (all - last);
  }
  return out;
}
