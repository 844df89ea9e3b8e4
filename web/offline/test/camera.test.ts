// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Camera, cornerOf, toPixel } from "../src/view/camera";
import { dot, len, sub, type Vec3 } from "../src/view/vec";

const box = { lo: [-1, -2, -3] as Vec3, hi: [1, 2, 3] as Vec3 };
const start = () => new Camera({ position: [0, -10, 2], target: [0, 0, 0], up: [0, 0, 1], angle: 30, parallel: false, height: 1 });

describe("camera", () => {
  it("fits a box with its margin at the sides where it is widest", () => {
    for (const parallel of [false, true]) {
      const c = start();
      c.parallel = parallel;
      c.fit(box, [0.3, -1, 0.4], [0, 0, 1], 1.6, 0.1);
      const p = c.projection(1600, 1000, 1, box), q = Array.from({ length: 8 }, (_, i) => toPixel(p, cornerOf(box, i)));
      const left = Math.min(...q.map((x) => x[0])), top = Math.min(...q.map((x) => x[1])), bottom = Math.max(...q.map((x) => x[1]));
      expect(Math.min(left - 160, top - 100)).toBeCloseTo(0, 3);
      expect(bottom).toBeLessThanOrEqual(900.001);
    }
  });
  it("turns about its target without being locked anywhere", () => {
    const c = start(), far = len(sub(c.position, c.target));
    for (let i = 0; i < 500; ++i) c.turn(0.07, 0.11);
    expect(len(sub(c.position, c.target))).toBeCloseTo(far, 9);
    expect(len(c.up)).toBeCloseTo(1, 9);
    expect(Math.abs(dot(c.up, sub(c.position, c.target)))).toBeLessThan(1e-6);
  });
  it("keeps the size of what it looks at when the projection changes", () => {
    const c = start(), size = () => {
      const p = c.projection(800, 600, 1, box);
      return toPixel(p, [1, 0, 0])[0] - toPixel(p, [0, 0, 0])[0];
    };
    const before = size();
    c.setParallel(true);
    expect(size()).toBeCloseTo(before, 0);
    c.setParallel(false);
    expect(size()).toBeCloseTo(before, 6);
  });
});
