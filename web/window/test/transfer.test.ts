// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { countFalls } from "../transfer/colors";
import { lightness, mapByName, maps } from "../transfer/maps";
import { addPoint, movePoint, opacityAt, opacityText, parseOpacity, removePoint, roundValues, snap, type Point } from "../transfer/opacity";
import { axisOf, share, valueAt } from "../transfer/scale";
import { gripped, newWidget, parseWidgets, widgetsText } from "../transfer/widgets";
import { randomNumbers } from "./random";

describe("opacity as text", () => {
  it("comes back from text as it was, for random curves", () => {
    const random = randomNumbers(3);
    for (let k = 0; k < 500; k++) {
      const range: [number, number] = [random() * 2000 - 1000, 1000 + random() * 1e5];
      const values = Array.from({ length: 1 + Math.floor(random() * 8) }, () => range[0] + random() * (range[1] - range[0])).sort((a, b) => a - b);
      const points: Point[] = values.map((v) => [v, Math.round(random() * 1000) / 1000]);
      const text = opacityText(points);
      const back = parseOpacity(text, range)!;
      expect(back).not.toBe(null);
      back.forEach((p, i) => {
        expect(Math.abs(p[0] - points[i][0])).toBeLessThanOrEqual(1e-6 * Math.max(1, Math.abs(points[i][0])));
        expect(p[1]).toBe(points[i][1]);
      });
      expect(opacityText(back)).toBe(text); // a second time it is the same to the letter
    }
  });

  it("reads shares of the range, values, steps and constants, and refuses what is none", () => {
    expect(parseOpacity("0:0,0.5:0.2,1:1", [100, 300])).toEqual([[100, 0], [200, 0.2], [300, 1]]);
    expect(parseOpacity("@-500:0,@200:0.4", [0, 1])).toEqual([[-500, 0], [200, 0.4]]);
    expect(parseOpacity("@1:0,@1:1", [0, 2])).toEqual([[1, 0], [1, 1]]);
    expect(parseOpacity("0.3", [0, 2])).toEqual([[0, 0.3], [2, 0.3]]);
    for (const bad of ["", "a:b", "@1:2", "1:0.5,0:0.5", "0:0,,1:1", "@1"]) expect(parseOpacity(bad, [0, 1])).toBe(null);
  });

  it("keeps points in order and within zero and one while they are dragged", () => {
    const points: Point[] = [[0, 0], [5, 0.5], [10, 1]];
    expect(movePoint(points, 1, 20, 3)[1]).toEqual([10, 1]);
    expect(movePoint(points, 1, -20, -3)[1]).toEqual([0, 0]);
    expect(addPoint(points, 7.5)).toEqual({ points: [[0, 0], [5, 0.5], [7.5, 0.75], [10, 1]], index: 2 });
    expect(removePoint([[1, 1]], 0)).toHaveLength(1);
    expect(opacityAt(points, -1)).toBe(0);
    expect(opacityAt(points, 2.5)).toBe(0.25);
  });

  it("snaps to marks within reach and lists round values", () => {
    expect(snap(101, 2, [100, 150])).toBe(100);
    expect(snap(104, 2, [100, 150])).toBe(104);
    expect(roundValues([-3, 11], 5)).toEqual([0, 5, 10]);
    expect(roundValues([0, 1], 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
    expect(roundValues([2, 2], 5)).toEqual([2]);
  });
});

describe("axes", () => {
  it("go from value to share and back, linear and logarithmic", () => {
    for (const scale of ["linear", "log"]) {
      const axis = axisOf([1, 1000], scale);
      for (const v of [1, 10, 500, 1000]) expect(valueAt(axis, share(axis, v))).toBeCloseTo(v, 9);
    }
    expect(share(axisOf([1, 100], "log"), 10)).toBeCloseTo(0.5, 12);
    expect(axisOf([-1, 1], "log").log).toBe(false);
  });
});

describe("widgets", () => {
  it("come back from text, and move within the plane", () => {
    const range: [number, number] = [-100, 300];
    const list = [newWidget("triangle", range, "tomato"), { ...newWidget("rectangle", range, "map"), opacity: 0.25 }];
    expect(parseWidgets(widgetsText(list), range)).toEqual(list);
    expect(parseWidgets("triangle 0.2 0.4 0 0.5", range)).toEqual([{ shape: "triangle", low: -20, high: 60, bottom: 0, top: 0.5, opacity: 1, color: "map" }]);
    expect(parseWidgets("circle 0 1 0 1", range)).toBe(null);
    const up = gripped(list[0], "body", 0.1, 5, range);
    expect(up.top).toBe(1);
    expect(up.low - list[0].low).toBeCloseTo(40, 9);
    expect(gripped(list[0], "low", 9, 0, range).low).toBe(list[0].high);
  });
});

describe("colour maps", () => {
  it("are known by name, also reversed, with the lightness of CIELAB", () => {
    expect(maps.length).toBeGreaterThan(20);
    expect(mapByName("viridis_r")?.colors[0]).toBe(mapByName("viridis")?.colors[16]);
    expect(mapByName("no such map")).toBe(undefined);
    expect(lightness("#ffffff")).toBeCloseTo(1, 4);
    expect(lightness("#000000")).toBe(0);
    expect(lightness("#777777")).toBeCloseTo(0.5, 2);
    expect(countFalls(mapByName("sight")!.colors.map(lightness))).toBe(0);
    expect(countFalls(mapByName("coolwarm")!.colors.map(lightness))).toBe(1);
    expect(countFalls(mapByName("hsv")!.colors.map(lightness))).toBeGreaterThan(2);
  });
});
