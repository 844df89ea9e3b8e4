// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { hexOf, hexOfNumbers, knownHex, numbersOfHex } from "../controls/color_text";
import { nextKey, toldOf } from "../panels/node_entries";
import { freeName } from "../panels/nodes";
import type { SceneNode, Shown, State, Step } from "../protocol";
import { selectionAfter } from "../session/selection";
import { wordsAt } from "../session/words_at";

const light = { kind: "sphere", words: {} };
const node = (name: string, parent = ""): SceneNode => ({ name, in: parent, words: {}, copies: 0, copies_of: "", keys: 0, copy_words: [], points_words: {}, key_words: [] });
const show: Shown = { kind: "surface", of: "skin", words: {} };
const state = (parts: Partial<State>): State => ({ steps: [] as Step[], show: [show], lights: [], environment: null, scene: [], picture: {}, ...parts }) as State;

describe("what is selected", () => {
  it("is what was just added", () => {
    expect(selectionAfter("show/0", state({ lights: [light, light] }), state({ lights: [light] }))).toBe("lights/1");
    expect(selectionAfter("show/0", state({ scene: [node("a"), node("lid", "a")] }), state({ scene: [node("a")] }))).toBe("scene/lid");
    expect(selectionAfter("lights/0", state({ show: [show, show] }), state({}))).toBe("show/1");
  });
  it("stays while it is there, and is a neighbour of what has gone", () => {
    expect(selectionAfter("scene/lid", state({ scene: [node("lid")] }), state({ scene: [node("a"), node("lid")] }))).toBe("scene/lid");
    expect(selectionAfter("lights/1", state({ lights: [light] }), state({ lights: [light, light] }))).toBe("lights/0");
    expect(selectionAfter("lights/0", state({}), state({ lights: [light] }))).toBe("show/0");
    expect(selectionAfter("scene/lid", state({}), state({ scene: [node("lid")] }))).toBe("show/0");
    expect(selectionAfter("show/0", state({ show: [] }), null)).toBe("picture");
  });
});

it("words are found by their place", () => {
  const s = state({
    show: [{ ...show, words: { color: "red" } }],
    steps: [{ name: "skin", operation: "contour", words: { values: "1" }, from: [] }],
    lights: [light, { kind: "sun", words: { haze: "2" } }],
    environment: { kind: "sky", words: { elevation: "7" } },
    scene: [{ ...node("a/b c"), words: { angle: "5" }, key_words: [{}, { time: "1" }], copy_words: [{ scale: "2" }], points_words: { size: "r" } }],
    picture: { title: "T" },
  });
  const places: [string, object][] = [["show/0", { color: "red" }], ["steps/skin", { values: "1" }], ["lights/1", { haze: "2" }], ["environment", { elevation: "7" }], ["scene/a/b c", { angle: "5" }], ["keys/1/a/b c", { time: "1" }], ["copies/0/a/b c", { scale: "2" }], ["points/a/b c", { size: "r" }], ["picture", { title: "T" }]];
  for (const [at, words] of places) expect(wordsAt(s, at), at).toEqual(words);
  for (const at of ["show/1", "steps/none", "lights/2", "scene/none", "keys/2/a/b c", "keys/0/none", "points/none"]) expect(wordsAt(s, at), at).toEqual({});
});

it("a key follows the last one at the pace of the keys", () => {
  expect(nextKey([])).toEqual({ time: "0" });
  expect(nextKey([{ angle: "5" }])).toEqual({ angle: "5", time: "1" });
  expect(nextKey([{ time: "1" }, { time: "1.5", angle: "9" }])).toEqual({ time: "2", angle: "9" });
  expect(nextKey([{ time: "{t}" }]).time).toBe("1");
  expect(toldOf({ time: "1", angle: "90", axis: "0,0,1" })).toBe("angle 90, axis 0,0,1");
});

it("a node gets a name that no other has", () => {
  expect(freeName(state({}), "skin")).toBe("skin");
  expect(freeName(state({ scene: [node("skin"), node("skin2")] }), "skin")).toBe("skin3");
});

describe("colours as text", () => {
  it("are #rrggbb and three numbers of the screen", () => {
    expect(knownHex("#FF8000")).toBe("#ff8000");
    expect(knownHex("1,0.5,0")).toBe("#ff8000");
    expect(knownHex("no colour")).toBe(null);
    expect(hexOf("")).toBe("#808080");
    expect(hexOfNumbers("0.09,0.1,0.16", false)).toBe("#171a29");
    expect(numbersOfHex("#ff8000", false, "")).toBe("1,0.502,0");
  });
  it("of light are in proportion to it, and come back to the same swatch", () => {
    expect(hexOfNumbers("0.2140,1,0", true)).toBe("#7fff00");
    for (const hex of ["#000000", "#010203", "#7f3a99", "#ffffff"]) expect(hexOfNumbers(numbersOfHex(hex, true, ""), true)).toBe(hex);
  });
  it("brighter than white stay as bright as they were", () => {
    expect(hexOfNumbers("8,8,0", true)).toBe("#ffff00");
    expect(numbersOfHex("#00ff00", true, "8,8,0")).toBe("0,8,0");
  });
});
