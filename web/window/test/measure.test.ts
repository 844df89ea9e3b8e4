// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { length } from "../camera/vector";
import { angleAt, areaNormal, lengthAlong, measured, simplified, unevenness } from "../measure/geometry";
import { keptFrom, keptText } from "../measure/kept";
import { measuredText, summary } from "../measure/rulers";
import { selectedText } from "../panels/numbers";
import type { Vec3 } from "../protocol";
import { regionOf } from "../questions/selections";

describe("measurements that are kept", () => {
  it("come back from their text, to the last digit", () => {
    const kept = [
      { name: "Width, at the base", points: [[0.1, 2, -1e-7], [1 / 3, 0, 5]] as Vec3[] },
      { name: "Angle 2", points: [[0, 0, 0], [1, 0, 0], [1, 1, 1e20]] as Vec3[] },
    ];
    expect(keptFrom(keptText(kept))).toEqual(kept);
    expect(keptFrom("")).toEqual([]);
    expect(keptFrom("nothing; half @ 1,2; a place alone @ 1,2,3; good @ 1,2,3 4,5,6").map((m) => m.name)).toEqual(["good"]);
    expect(keptFrom(keptText([{ name: "a;b @ c", points: [[1, 2, 3], [4, 5, 6]] }]))[0].name).toBe("a b c");
  });
});

describe("places that are clicked", () => {
  it("measure what their number allows", () => {
    expect(measured([[0, 0, 0]])).toEqual([]);
    expect(measured([[0, 0, 0], [3, 4, 12]])).toEqual([{ what: "distance", value: 13 }]);
    const three = measured([[1, 0, 0], [0, 0, 0], [0, 0, 2]]);
    expect(three.map((m) => m.what)).toEqual(["angle", "area"]);
    expect(three[0].value).toBeCloseTo(90, 12);
    expect(three[1].value).toBeCloseTo(1, 12);
    const square = measured([[0, 0, 5], [2, 0, 5], [2, 2, 5], [0, 2, 5]]);
    expect(square.map((m) => m.what)).toEqual(["length", "area"]);
    expect(square[0].value).toBeCloseTo(6, 12); // along, not around
    expect(square[1].value).toBeCloseTo(4, 12);
  });

  it("have exact angles, small ones too", () => {
    expect(angleAt([1, 0, 0], [0, 0, 0], [1, 1e-9, 0])).toBeCloseTo((1e-9 * 180) / Math.PI, 15);
    expect(angleAt([1, 0, 0], [0, 0, 0], [-1, 0, 0])).toBeCloseTo(180, 12);
    expect(angleAt([0, 0, 0], [0, 0, 0], [1, 0, 0])).toBe(0);
  });

  it("have the area of any flat polygon, wherever it lies and however it is turned", () => {
    const tilt = (x: number, y: number): Vec3 => [1e6 + 0.6 * x, y, 0.8 * x - 1e6];
    const letter = [tilt(0, 0), tilt(2, 0), tilt(2, 1), tilt(1, 1), tilt(1, 2), tilt(0, 2)]; // an L of three unit squares
    expect(length(areaNormal(letter))).toBeCloseTo(3, 8);
    expect(unevenness(letter)).toBeLessThan(1e-9);
    expect(lengthAlong(letter)).toBeCloseTo(6, 8); // without the last side
  });

  it("say when they do not lie in a plane", () => {
    const bent: Vec3[] = [[0, 0, 0.1], [1, 0, -0.1], [1, 1, 0.1], [0, 1, -0.1]];
    // Each corner is 0.1 off, and they lie 2 sqrt(0.51) apart.
    expect(unevenness(bent)).toBeCloseTo(0.1 / (2 * Math.sqrt(0.51)), 9);
    expect(summary(bent, "mm")).toMatch(/not flat$/);
    expect(summary([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "mm")).toBe("length 3 mm, area 1 mm²");
    expect(measuredText({ what: "angle", value: 45 }, "mm")).toBe("45°");
    expect(measuredText({ what: "distance", value: 2 }, "")).toBe("2");
  });
});

describe("outlines", () => {
  it("lose corners that lie on the way, and no others", () => {
    const line = Array.from({ length: 50 }, (_, i): [number, number] => [i, 0]);
    expect(simplified(line, 0.5)).toEqual([[0, 0], [49, 0]]);
    const corner: [number, number][] = [...line, ...Array.from({ length: 20 }, (_, i): [number, number] => [49, i + 1])];
    expect(simplified(corner, 0.5)).toEqual([[0, 0], [49, 0], [49, 20]]);
    const circle = Array.from({ length: 400 }, (_, i): [number, number] => [100 * Math.cos((i * Math.PI) / 200), 100 * Math.sin((i * Math.PI) / 200)]);
    const few = simplified(circle, 0.75);
    expect(few.length).toBeLessThan(60);
    // Chords of a circle that are 0.75 off at most leave more than 98 % of its area.
    const area = few.reduce((sum, [x, y], i) => sum + (x * few[(i + 1) % few.length][1] - few[(i + 1) % few.length][0] * y) / 2, 0);
    expect(Math.abs(area)).toBeGreaterThan(0.98 * Math.PI * 1e4);
  });

  it("are read from the words of a step", () => {
    expect(regionOf([{ operation: "threshold", set: { field: "ct" } }])).toBe(null);
    expect(regionOf([{ operation: "extract", set: { lasso: "0,0,0,1,0,0,0,1,0", lasso_eye: "0,0,5" } }])).toEqual({ lasso: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], eye: [0, 0, 5] });
    expect(regionOf([{ operation: "extract", set: { lasso: "0,0,0,1,0,0,0,1,0" } }])?.eye).toBe(null);
  });
});

it("a selection is told in a sentence, with its unit", () => {
  const a = { is: "measures" as const, n: 1, points: 1234, cells: 99, measure: 8, dimension: 3, length_unit: "mm", fields: [], steps: [] };
  expect(selectedText(a)).toBe("1,234 points · 99 cells · volume 8 mm³");
  expect(selectedText({ ...a, measure: null, dimension: null })).toBe("1,234 points · 99 cells");
  expect(selectedText({ ...a, dimension: 2, length_unit: "" })).toBe("1,234 points · 99 cells · area 8");
});
