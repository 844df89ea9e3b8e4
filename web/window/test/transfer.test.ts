// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { countFalls } from "../transfer/colors";
import { lightness, mapByName, maps } from "../transfer/maps";
import { addPoint, movePoint, opacityAt, opacityText, parseOpacity, removePoint, roundValues, snap, type Point } from "../transfer/opacity";
import { axisOf, share, valueAt } from "../transfer/scale";
import { distance, mostPoints, radiiOf, simplified, stroke } from "../transfer/brush";
import { boxes, gripped, newWidget, paint, parseWidgets, widgetsText } from "../transfer/widgets";
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

  it("of all shapes come back from text, wherever they are moved", () => {
    const random = randomNumbers(5);
    const range: [number, number] = [-1000, 3000];
    for (let k = 0; k < 200; k++) {
      const path = Array.from({ length: 1 + Math.floor(random() * 20) }, (): [number, number] => [random(), random()]);
      const drawn = [...boxes.map((b) => newWidget(b, range, "gold")), stroke(path, radiiOf(0.01 + 0.1 * random(), range, 0.5), range, 0.5, "map")];
      expect(parseWidgets(widgetsText(drawn), range)).toEqual(drawn);
      const moved = drawn.map((w) => gripped(w, "body", random() - 0.5, random() - 0.5, range));
      expect(parseWidgets(widgetsText(moved), range)!.map((w) => w.shape)).toEqual(drawn.map((w) => w.shape));
    }
  });

  it("read places and radii in either form, and refuse what is none", () => {
    const one = parseWidgets("paint 0.05:@20 0.5,@100 @300,0.25 0.7 1,0,0", [-100, 300], [0, 200])!;
    expect(one).toEqual([paint([[100, 0.5], [300, 0.25]], [20, 0.1], 0.7, "1,0,0")]);
    expect([one[0].low, one[0].high, one[0].bottom, one[0].top]).toEqual([80, 320, 0.15, 0.6]);
    expect(parseWidgets("paint 1:1 0,0", [0, 1])).toEqual([paint([[0, 0]], [1, 1], 1, "map")]);
    expect(parseWidgets("ellipse 0 0.5 @0 @100", [0, 1], [0, 200])![0].top).toBe(0.5);
    expect(parseWidgets("ellipse 0 0.5 @0 @100", [0, 1])).toBe(null); // the second axis is not known yet
    for (const bad of ["paint", "paint 1 0,0", "paint 1:1", "paint 0:1 0,0", "paint 1:1:1 0,0", "paint 1:1 0,x", "paint 1:1 0,0 1 red 2", "ellipse 0 1 0", "ellipse 0 1 0 1 1 red 5"])
      expect(parseWidgets(bad, [0, 1])).toBe(null);
  });

  it("keep the form of a stroke when keys change its brush", () => {
    const w = paint([[0, 0.5], [10, 0.6]], [1, 0.1], 0.5, "gold");
    const moved = gripped(w, "body", 0.1, 0.2, [0, 100]);
    expect(moved.line).toEqual([[10, 0.7], [20, 0.8]]);
    expect(gripped(w, "high", 0.02, 0, [0, 100]).radius).toEqual([2, 0.1]);
    expect(gripped(w, "top", 0, -9, [0, 100]).radius).toEqual([1, 0.002]);
  });
});

describe("the brush", () => {
  it("keeps few points of a path, none of which lies farther off than a tenth of its radius", () => {
    const random = randomNumbers(9);
    for (let k = 0; k < 30; k++) {
      const radius: [number, number] = [5 + 20 * random(), 0.01 + 0.1 * random()];
      let at: [number, number] = [100 * random(), random()];
      const path = Array.from({ length: 2 + Math.floor(random() * 400) }, (): [number, number] => (at = [at[0] + 4 * (random() - 0.4), at[1] + 0.02 * (random() - 0.5)]));
      const kept = simplified(path, radius);
      expect(kept.length).toBeLessThanOrEqual(Math.min(path.length, mostPoints));
      expect(kept[0]).toEqual(path[0]);
      expect(kept[kept.length - 1]).toEqual(path[path.length - 1]);
      const off = path.map((p) => Math.min(...kept.slice(1).map((b, i) => distance(p, kept[i], b, radius))));
      expect(Math.max(...off)).toBeLessThanOrEqual(0.1 + 1e-9);
    }
    expect(simplified([[0, 0], [0, 0]], [1, 1])).toEqual([[0, 0]]);
    expect(simplified([[0, 0], [1, 1], [2, 2], [3, 3]], [1, 1])).toEqual([[0, 0], [3, 3]]);
    const wild = Array.from({ length: 600 }, (_, i): [number, number] => [i % 2, i % 3]);
    expect(simplified(wild, [0.01, 0.01]).length).toBeLessThanOrEqual(mostPoints);
  });

  it("is round as it is seen, and writes few digits", () => {
    expect(radiiOf(0.05, [0, 4000], 0.5)).toEqual([200, 0.1]);
    expect(widgetsText([stroke([[0.1234567, 0.7654321]], [200, 0.1], [-1000, 3000], 0.6, "gold")])).toBe("paint @200:0.1 @-506,0.765 0.6 gold");
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
