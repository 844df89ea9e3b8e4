// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { join, trail } from "../chooser";
import { actionOf, keys, nameOf } from "../input/keys";
import { sideAt } from "../panels/legend";
import { place } from "../panels/layout";
import { fitted, sizeProblem } from "../panels/save_size";
import { splitFrame } from "../protocol";
import { figure } from "../questions/figure";
import { csv, diff } from "../questions/files";
import { following, nearest } from "../session/player";
import { movedTo, outline, planeOf } from "../slices/plane";
import { levelled } from "../view/window_level";
import { bytes, numbers, plain, quoted, seconds, short } from "../words";

const box: [number, number, number, number, number, number] = [0, 10, 0, 20, 0, 30];

describe("planes", () => {
  it("are read from words as the operation reads them, and written back", () => {
    expect(planeOf("slice", {}, box)).toEqual({ origin: [5, 10, 15], normals: [[0, 0, 1]], word: "origin" });
    const x = planeOf("clip", { axis: "x", position: "3" }, box)!;
    expect(x.origin).toEqual([3, 10, 15]);
    expect(movedTo(x, [4, 0, 0], box)).toEqual({ position: "4" });
    expect(movedTo(x, [40, 0, 0], box)).toEqual({ position: "10" }); // within the data
    const three = planeOf("slice", { planes: "xyz", origin: "1,2,3" }, box)!;
    expect(three.normals).toHaveLength(3);
    expect(movedTo(three, [2, 3, 4], box)).toEqual({ origin: "2,3,4" });
    expect(planeOf("slice", { sphere: "0,0,0,1" }, box)).toBe(null);
    expect(planeOf("contour", {}, box)).toBe(null);
  });

  it("have outlines that lie in them", () => {
    for (const p of outline([5, 10, 15], [0.6, 0, 0.8], box)) expect(0.6 * (p[0] - 5) + 0.8 * (p[2] - 15)).toBeCloseTo(0, 9);
  });
});

describe("the graph", () => {
  it("places forks side by side and joins below both, no two in one place", () => {
    const steps = [
      { name: "a", from: [] }, { name: "b", from: ["a"] }, { name: "c", from: ["a"] }, { name: "d", from: ["b", "c"] }, { name: "e", from: [] }, { name: "loop", from: ["loop"] },
    ];
    const at = Object.fromEntries(place(steps).map((p) => [p.name, p]));
    expect(at.b.column).toBe(1);
    expect(at.c.column).toBe(1);
    expect(at.b.row).not.toBe(at.c.row);
    expect(at.d.column).toBe(2);
    expect(new Set(place(steps).map((p) => `${p.column} ${p.row}`)).size).toBe(steps.length);
  });
});

describe("numbers and words", () => {
  it("are short, and are read back", () => {
    expect(short(0.1 + 0.2)).toBe("0.3");
    expect(plain(-1234567)).toBe("−1.235e6");
    expect(plain(0.00001)).toBe("1e−5");
    expect(plain(NaN)).toBe("–");
    expect(numbers("1, 2  3;4")).toEqual([1, 2, 3, 4]);
    expect(numbers("1,x")).toBe(null);
    expect(bytes(12_300_000)).toBe("12 MB");
    expect(seconds(0.034)).toBe("34 ms");
    expect(quoted("volume a=1")).toBe("'volume a=1'");
    expect(quoted("it's")).toBe("'it'\\''s'");
  });

  it("become tables and figures", () => {
    expect(csv(["a", "b,c"], [[1, null], ['x"y', 2]])).toBe('a,"b,c"\r\n1,\r\n"x""y",2\r\n');
    const f = figure({ x: [0, 1, 2, 3], values: [1, null, 2, 3] }, "d <m>", "v");
    expect(f).toContain("d &lt;m&gt;");
    expect(f.match(/d="M[^"]*M/)).not.toBe(null); // a gap
  });

  it("are compared line by line", () => {
    expect(diff("a\nb\nc", "a\nc\nd")).toEqual([
      { mark: " ", text: "a" }, { mark: "-", text: "b" }, { mark: " ", text: "c" }, { mark: "+", text: "d" },
    ]);
  });
});

describe("times", () => {
  it("play within their range, round or to the end", () => {
    expect(following(3, 2, 4, true)).toBe(4);
    expect(following(4, 2, 4, true)).toBe(2);
    expect(following(4, 2, 4, false)).toBe(null);
    expect(following(0, 2, 4, true)).toBe(2);
    expect(following(2, 2, 2, true)).toBe(null);
    expect(nearest([0, 0.5, 1], 0.7)).toBe(1);
  });
});

describe("window and level", () => {
  it("widen to the right, and never turn over", () => {
    const [a, b] = levelled([0, 100], 1000, 0.3, 0);
    expect(b - a).toBeGreaterThan(100);
    expect((a + b) / 2).toBeCloseTo(50, 9);
    const [c, d] = levelled([0, 100], 1000, -50, 0.5);
    expect(d).toBeGreaterThan(c);
  });
});

it("a served folder knows the folders above it", () => {
  expect(trail("a/b")).toEqual([["a", "a"], ["b", "a/b"]]);
  expect(trail("")).toEqual([]);
  expect(join("", "x.vti")).toBe("x.vti");
  expect(join("a", "x.vti")).toBe("a/x.vti");
});

it("a picture to save has the size that was typed, or a problem and one of its shape that may be", () => {
  const most = 4096 * 4096;
  expect(fitted(1920, 1080, most)).toEqual([1920, 1080]);
  expect(sizeProblem(4096, 4096, most)).toBe("");
  const [w, h] = fitted(16384, 8192, most);
  expect(w * h).toBeLessThanOrEqual(most);
  expect(w / h).toBeCloseTo(2, 2);
  expect(sizeProblem(16384, 8192, most)).toContain(`16.8 million pixels that a picture may have; ${w} × ${h}`);
});

describe("keys", () => {
  const press = (key: string, more: Partial<KeyboardEvent> = {}): string => nameOf({ key, ctrlKey: false, metaKey: false, shiftKey: false, altKey: false, ...more });
  it("are told apart by modifiers and place", () => {
    expect(actionOf(press("ArrowLeft"), true)).toBe("turn-left");
    expect(actionOf(press("ArrowLeft", { shiftKey: true }), true)).toBe("pan-left");
    expect(actionOf(press("ArrowLeft"), false)).toBe(null);
    expect(actionOf(press("z", { ctrlKey: true }), false)).toBe("undo");
    expect(actionOf(press("Z", { metaKey: true, shiftKey: true }), false)).toBe("redo");
    expect(actionOf(press("?", { shiftKey: true }), false)).toBe("help");
    expect(actionOf(press("F"), false)).toBe("full-screen");
    expect(actionOf(press("f", { ctrlKey: true }), false)).toBe(null); // the browser's own search
  });
  it("have one meaning each", () => {
    const all = keys.flatMap((k) => k.keys);
    expect(new Set(all).size).toBe(all.length);
  });
});

it("a legend goes to the nearest side", () => {
  expect(sideAt(0.1, 0.5)).toBe("left");
  expect(sideAt(0.5, 0.95)).toBe("bottom");
});

it("a frame is split into header and picture, and refused when cut short", () => {
  const head = new TextEncoder().encode('{"is":"frame","n":3}');
  const message = new Uint8Array(4 + head.length + 2);
  new DataView(message.buffer).setUint32(0, head.length, true);
  message.set(head, 4);
  message.set([7, 8], 4 + head.length);
  const { header, picture } = splitFrame(message.buffer);
  expect(header.n).toBe(3);
  expect([...picture]).toEqual([7, 8]);
  for (let n = 0; n < 4 + head.length; n++) expect(() => splitFrame(message.buffer.slice(0, n))).toThrow();
});
