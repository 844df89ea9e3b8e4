// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import type { Catalog } from "../catalog";
import { cell, drawingOf } from "../panels/edges";
import { portAt, portsOf, type Port } from "../panels/ports";
import type { State, Step } from "../protocol";
import { canGo, hangingOn, mayTake, removal, slotsOf, takersOf, withInput } from "../session/wiring";

const step = (name: string, from: string[], kind = "surface"): Step => ({ name, operation: name, words: {}, from, kind });
const show = (of: string): State["show"][number] => ({ kind: "surface", of, words: {} });
const state = (steps: Step[], shown: string[] = []): State => ({ steps, show: shown.map(show), scene: [{ name: "n", in: "", words: {}, copies: 0, copies_of: "cut", keys: 0 }] }) as unknown as State;
const forked = [step("ball", [], "uniform"), step("skin", ["ball"]), step("smooth", ["skin"]), step("cut", ["ball"]), step("both", ["smooth", "cut"])];

describe("what a step may take", () => {
  it("is all that does not hang on it", () => {
    expect([...hangingOn(forked, "skin")]).toEqual(["skin", "smooth", "both"]);
    expect(mayTake(forked, "skin").map((s) => s.name)).toEqual(["ball", "cut"]);
    expect(mayTake(forked, "both").map((s) => s.name)).toEqual(["ball", "skin", "smooth", "cut"]);
  });
  it("has a place for each input of its operation, and one for a further one", () => {
    const places = (inputs: [number, number] | undefined, from: string[]): string[] => slotsOf({ inputs }, from).map((s) => `${s.takes}${s.optional ? "?" : ""}`);
    expect(places([1, 1], ["a"])).toEqual(["a"]);
    expect(places([1, 2], ["a"])).toEqual(["a", "?"]);
    expect(places([1, 2], ["a", "b"])).toEqual(["a?", "b?"]);
    expect(places([2, 2], ["a"])).toEqual(["a", ""]);
    expect(places([2, -1], ["a", "b"])).toEqual(["a", "b", "?"]);
    expect(places([1, -1], ["a", "b", "c"])).toHaveLength(4);
    expect(places(undefined, [])).toEqual([]); // of a source
    expect(places(undefined, ["a"])).toEqual(["a"]);
  });
  it("changes in one place", () => {
    expect(withInput(["a", "b"], 1, "c")).toEqual(["a", "c"]);
    expect(withInput(["a"], 1, "c")).toEqual(["a", "c"]);
    expect(withInput(["a", "b"], 0, "")).toEqual(["b"]);
  });
});

describe("ports of the graph", () => {
  const catalog = { operations: [{ name: "both", inputs: [2, -1] }, { name: "cut", inputs: [1, 1] }], sources: [{ name: "ball", inputs: [0, 0] }] } as unknown as Catalog;
  const { corners, edges } = drawingOf(forked);
  const ports = forked.flatMap((s) => portsOf({ catalog }, s, corners.get(s.name)!));
  const of = (name: string): Port[] => ports.filter((p) => p.step === name);
  const inside = (name: string, x: number): [number, number] => [corners.get(name)![0] + x, corners.get(name)![1] + cell.tall / 2];
  it("stand where edges arrive, free ones beside them; a source has none", () => {
    expect(of("ball")).toEqual([]);
    expect(of("cut")).toHaveLength(1);
    expect(of("both").map((p) => p.index)).toEqual([0, 1, 2]);
    for (const e of edges) expect(of(e.to).some((p) => e.path.endsWith(`${p.at[0]} ${p.at[1]}`)), `${e.from} to ${e.to}`).toBe(true);
    expect(of("both")[2].at[0]).toBeGreaterThan(of("both")[1].at[0]);
  });
  it("are found from all of a box, the nearest one, but not from the step itself", () => {
    expect(portAt(ports, corners, "ball", inside("both", 0))?.index).toBe(0);
    expect(portAt(ports, corners, "ball", inside("both", cell.box))?.index).toBe(2);
    expect(portAt(ports, corners, "both", inside("both", 40))).toBe(null);
    expect(portAt(ports, corners, "cut", inside("ball", 40))).toBe(null);
    expect(portAt(ports, corners, "cut", [-100, -100])).toBe(null);
  });
});

describe("a step that goes", () => {
  it("leaves what took it to its first input", () => {
    const s = state(forked, ["skin", "smooth", "cut"]);
    expect(takersOf(s, "cut").map((t) => t.place)).toEqual(["steps/both", "show/2", "scene/n"]);
    expect(removal(s, forked[1])).toEqual({ remove: "steps/skin", join: ["steps/smooth"] });
    expect(removal(s, forked[3])).toEqual({ remove: "steps/cut", join: ["steps/both", "scene/n"] });
    expect(removal(s, forked[4])).toEqual({ remove: "steps/both", join: [] });
  });
  it("leaves its look as well, where that is of one kind and not seen yet", () => {
    expect(removal(state(forked, ["smooth"]), forked[2])).toEqual({ remove: "steps/smooth", join: ["steps/both", "show/0"] });
    expect(removal(state(forked, ["skin", "smooth"]), forked[2])).toEqual({ remove: "steps/smooth", join: ["steps/both"] });
  });
  it("is not one that others have nothing in place of", () => {
    const s = state(forked);
    expect(forked.map((x) => canGo(s, x))).toEqual([false, true, true, true, true]);
    const alone = state([step("a", []), step("b", [])], ["a"]);
    expect(canGo(alone, alone.steps[0])).toBe(true);
    expect(canGo(state([step("a", [])]), step("a", []))).toBe(false);
  });
});

describe("edges of the graph", () => {
  const { edges, corners, size } = drawingOf([...forked, step("late", ["both", "ball"])]);
  const inside = ([x, y]: [number, number]): string[] =>
    [...corners].filter(([, [x0, y0]]) => x > x0 && x < x0 + cell.box && y > y0 && y < y0 + cell.tall).map(([name]) => name);
  it("lead from each input to its step, in order", () => {
    expect(edges.map((e) => `${e.from}>${e.to}`)).toEqual(["ball>skin", "skin>smooth", "ball>cut", "smooth>both", "cut>both", "both>late", "ball>late"]);
  });
  it("have room in their middle for a button, beside all boxes and within the drawing", () => {
    for (const [i, e] of edges.entries()) {
      expect(inside(e.middle), `${e.from}>${e.to}`).toEqual([]);
      expect(e.middle[0]).toBeGreaterThan(7);
      expect(e.middle[0]).toBeLessThan(size[0] - 7);
      for (const other of edges.slice(0, i)) expect(Math.hypot(e.middle[0] - other.middle[0], e.middle[1] - other.middle[1])).toBeGreaterThan(12);
    }
  });
});
