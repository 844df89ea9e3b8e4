// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { bricksOf, distances } from "../src/volume/bricks";
import { largestOpacity, opacityAt } from "../src/volume/transfer";

describe("opacity", () => {
  const curve: [number, number][] = [[0, 0], [1, 0.5], [1, 0.2], [3, 0.4]];
  it("is straight between points, constant beyond, and jumps where two have one value", () => {
    expect([-1, 0.5, 1, 2, 9].map((v) => opacityAt(curve, v))).toEqual([0, 0.25, 0.2, expect.closeTo(0.3, 12), 0.4]);
    expect(opacityAt([], 1)).toBe(0);
    expect(opacityAt(curve, NaN)).toBe(0);
    expect(largestOpacity(curve, 0, 3)).toBe(0.5);
  });
});

describe("bricks", () => {
  it("know their range with the voxels beside them, and how far the next one is", () => {
    const n = 64, codes = new Uint8Array(n * 16 * 16);
    codes[40 + n * (3 + 16 * 3)] = 255;  // first voxel of the sixth brick
    const b = bricksOf(codes, [n, 16, 16], 255);
    expect(b.dims).toEqual([8, 2, 2]);
    expect([3, 4, 5, 6].map((i) => b.hi[i])).toEqual([0, 1, 1, 0]);
    const d = distances(b, (_, hi) => hi > 0.5);
    expect(Array.from(d.slice(0, 8))).toEqual([4, 3, 2, 1, 0, 0, 1, 2]);
    expect(d[4 + 8]).toBe(1);
  });
});
