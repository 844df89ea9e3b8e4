// SPDX-License-Identifier: Apache-2.0
// Bricks of voxels: the range of values in each, and how far from each the next lies in which something is drawn.

export const edge = 8;

export interface Bricks {
  dims: [number, number, number];
  lo: Float32Array;  // of codes from 0 to 1
  hi: Float32Array;
}

/** Ranges with the voxels next to each brick, between which its border interpolates. */
export function bricksOf(codes: Uint8Array | Uint16Array, dims: readonly [number, number, number], full: number): Bricks {
  const n = dims.map((d) => Math.max(1, Math.ceil(d / edge))) as [number, number, number], count = n[0] * n[1] * n[2];
  const lo = new Float32Array(count).fill(Infinity), hi = new Float32Array(count).fill(-Infinity);
  const per = 1 / full;
  const reach = (i: number, a: number): [number, number] => [Math.max(0, Math.floor((i - 1) / edge)), Math.min(n[a] - 1, Math.floor((i + 1) / edge))];
  for (let k = 0; k < dims[2]; ++k) {
    const z = reach(k, 2);
    for (let j = 0; j < dims[1]; ++j) {
      const y = reach(j, 1), row = dims[0] * (j + dims[1] * k);
      // The row's own bricks first, then those of all rows that it borders on.
      for (let bx = 0; bx < n[0]; ++bx) {
        let least = 65535, most = 0;
        for (let i = Math.max(0, bx * edge - 1), end = Math.min(dims[0], (bx + 1) * edge + 1); i < end; ++i) {
          const v = codes[row + i];
          if (v < least) least = v;
          if (v > most) most = v;
        }
        for (let bz = z[0]; bz <= z[1]; ++bz)
          for (let by = y[0]; by <= y[1]; ++by) {
            const b = bx + n[0] * (by + n[1] * bz);
            if (least * per < lo[b]) lo[b] = least * per;
            if (most * per > hi[b]) hi[b] = most * per;
          }
      }
    }
  }
  return { dims: n, lo, hi };
}

/** Per brick 0 where something is drawn, else how many bricks around it draw nothing (at most 15). */
export function distances(b: Bricks, drawn: (lo: number, hi: number) => boolean): Uint8Array {
  const [nx, ny, nz] = b.dims, most = 15, out = new Uint8Array(nx * ny * nz);
  for (let i = 0; i < out.length; ++i) out[i] = drawn(b.lo[i], b.hi[i]) ? 0 : most;
  // The largest of the distances along the axes (Chebyshev), by one pass each way over the neighbours that came before.
  const relax = (step: 1 | -1) => {
    const range = (n: number) => Array.from({ length: n }, (_, i) => (step > 0 ? i : n - 1 - i));
    const X = range(nx), Y = range(ny), Z = range(nz);
    for (const z of Z) for (const y of Y) for (const x of X) {
      const at = x + nx * (y + ny * z);
      let d = out[at];
      if (d === 0) continue;
      for (let c = -1; c <= 1; ++c) for (let e = -1; e <= 1; ++e) for (let a = -1; a <= 1; ++a) {
        const order = (c * 9 + e * 3 + a) * step;
        if (order >= 0) continue;
        const px = x + a, py = y + e, pz = z + c;
        if (px < 0 || py < 0 || pz < 0 || px >= nx || py >= ny || pz >= nz) continue;
        d = Math.min(d, out[px + nx * (py + ny * pz)] + 1);
      }
      out[at] = d;
    }
  };
  relax(1), relax(-1);
  return out;
}
