// SPDX-License-Identifier: Apache-2.0
// Against the program's own catalogue: SIGHTGLASS names the program, else build/sightglass of this checkout is used.
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { named, search, stepEntry, takesKind, wantsFile, type Catalog, type Entry, type Schema } from "../catalog";
import { choicesOf, factorRange, isColor, kindOf, sliderRange, typesOf } from "../controls/kind";
import { mapTable } from "../transfer/map_table";

const program = process.env.SIGHTGLASS ?? "../build/sightglass";
const found = existsSync(program);
const run = (...args: string[]): string => execFileSync(program, args, { maxBuffer: 1 << 26, encoding: "utf8" });

// What is free text, and why no other control would do.
const free: Record<string, string> = {
  "as name names title caption note x_title y_title z_title legend_title legend_unit unit": "a name or a sentence that a person makes up",
  "expr function initial initial_u initial_v held value source diffusivity velocity kinetic potential coordinates places": "an expression",
  "sides x0 x1 y0 y1 z0 z1": "what lies at a side of a box: words with velocities, or an expression",
  "component": "a number or a letter",
  "times": "first:last:count, or a list",
  "layout size views": "of whole pictures; the window has its own views and sizes",
  "legend_format format type types": "a word that another standard defines",
  "part blocks": "paths within a collection, which the session does not list",
  "clip colors widgets transfer": "a notation of their own; the tab of colours writes colors and widgets",
  "second shape size_by": "one of some words or a field, which are suggested",
  "color": "of tensor glyphs: one of some words or a field; colours have a control of their own",
  "x y z": "a column of a table; the fields are suggested",
  "lights environment": "kinds with words of their own",
  "file": "the name of a camera in the file that is shown",
  "measurements": "what a window keeps for itself",
};
const known = new Set(Object.keys(free).flatMap((names) => names.split(" ")));

describe.skipIf(!found)("the catalogue", () => {
  const catalog = found ? (JSON.parse(run("ops", "--json")) as Catalog) : ({} as Catalog);
  const entries = found ? [...catalog.sources, ...catalog.operations, ...catalog.show, ...(catalog.readers ?? []), catalog.read, catalog.camera, catalog.picture, ...catalog.lights, ...catalog.environments, ...catalog.nodes] : [];
  const all: [Entry, string, Schema][] = entries.flatMap((e) => Object.entries(e.params.properties).map(([n, s]): [Entry, string, Schema] => [e, n, s]));

  it("gives every parameter the control of its type", () => {
    expect(all.length).toBeGreaterThan(1000);
    for (const [e, name, s] of all) {
      const kind = kindOf(name, s);
      const types = typesOf(s);
      const where = `${e.name}.${name}`;
      if (s.field) expect(kind, where).toBe("field");
      else if (isColor(s)) expect(kind, where).toBe("color");
      else if (choicesOf(s).length > 0) expect(["choice", "choices"], where).toContain(kind);
      else if (types.includes("boolean")) expect(kind, where).toBe("switch");
      else if (types.includes("number") || types.includes("integer")) expect(kind, where).toBe("number");
      else if (types.includes("array")) expect(["vector", "numbers", "ends", "fields", "texts"], where).toContain(kind);
      else expect(["text", "file", "color", "map", "opacity"], where).toContain(kind);
    }
  });

  it("leaves to free text only what is free text", () => {
    const odd = new Set<string>();
    for (const [, name, s] of all) {
      const kind = kindOf(name, s);
      if ((kind === "text" || kind === "texts") && !known.has(name)) odd.add(name);
    }
    expect([...odd].sort()).toEqual([]);
  });

  it("knows every colour, as a word and as three numbers", () => {
    const colors = new Set(all.filter(([, n, s]) => kindOf(n, s) === "color").map(([e, n]) => `${e.kind} ${e.name} ${n}`));
    for (const c of ["show surface color", "show surface nan", "show lines halo_color", "show surface isoline_color", "show surface transmission_color", "show surface emission", "picture picture background", "operation trails color", "environment even color"])
      expect(colors, c).toContain(c);
    for (const light of catalog.lights.filter((l) => !["sun", "file"].includes(l.name))) expect(colors).toContain(`light ${light.name} color`);
    expect(colors).not.toContain("operation tensor_glyphs color");
    for (const [e, n, s] of all) if (/^Colour (of|where)\b/.test(s.description ?? "")) expect(isColor(s), `${e.name}.${n}`).toBe(true);
  });

  it("gives the strength of every light a slider of magnitudes", () => {
    for (const e of catalog.lights) expect(factorRange(e.params.properties.brightness), e.name).toEqual({ min: 0.01, max: 100 });
    expect(named(catalog.nodes, "node")?.params.properties.translate).toBeDefined();
    expect(catalog.environments.filter(wantsFile).map((e) => e.name)).toEqual(["panorama"]);
  });

  it("gives sliders only where both ends are known and near", () => {
    for (const [e, name, s] of all) {
      const r = sliderRange(s);
      if (!r) continue;
      expect(r.max - r.min, `${e.name}.${name}`).toBeLessThanOrEqual(1000);
      if (typeof s.default === "number") {
        expect(s.default).toBeGreaterThanOrEqual(r.min);
        expect(s.default).toBeLessThanOrEqual(r.max);
      }
    }
  });

  it("finds operations by name and by what they do", () => {
    expect(search(catalog.operations, "contour")[0].name).toBe("contour");
    expect(search(catalog.operations, "isosurface")[0].name).toBe("contour");
    expect(search(catalog.operations, "no such thing")).toEqual([]);
    expect(stepEntry(catalog, "read")?.kind).toBe("read");
    expect(takesKind(stepEntry(catalog, "label_surface")!, "unstructured")).toBe(false);
    expect(takesKind(stepEntry(catalog, "contour")!, "uniform")).toBe(true);
  });

  it("has the colour maps of the table, in its order", () => {
    const { colormaps } = JSON.parse(run("colormap", "--json")) as { colormaps: { name: string; kind: string }[] };
    expect(mapTable.map((m) => [m[0], m[1]])).toEqual(colormaps.map((m) => [m.name, m.kind]));
  });
});

it("gives each kind of schema its control", () => {
  expect(kindOf("x", { type: "boolean" })).toBe("switch");
  expect(kindOf("x", { type: ["number", "null"] })).toBe("number");
  expect(kindOf("x", { type: ["string", "null"], enum: ["a", null] })).toBe("choice");
  expect(kindOf("x", { type: "array", items: { type: "string", enum: ["a"] } })).toBe("choices");
  expect(kindOf("origin", { type: "array", items: { type: "number" }, minItems: 3, maxItems: 3 })).toBe("vector");
  expect(kindOf("values", { type: "array", items: { type: "number" } })).toBe("numbers");
  expect(kindOf("range", { type: "array", items: { type: "number" }, unit: "@field" })).toBe("ends");
  expect(sliderRange({ type: "number", unit: "@field" }, [3, 7])).toMatchObject({ min: 3, max: 7 });
  expect(sliderRange({ type: "integer", minimum: 0, maximum: 1e9 })).toBe(null);
  expect(kindOf("color", { type: "string", unit: "color" })).toBe("color");
  expect(kindOf("emission", { type: ["array", "null"], items: { type: "number" }, minItems: 3, maxItems: 3, unit: "linear color" })).toBe("color");
  expect(factorRange({ type: "number", exclusiveMinimum: 0, maximum: 1e9, default: 1 })).toEqual({ min: 0.01, max: 100 });
  expect(factorRange({ type: "number", exclusiveMinimum: 0, default: 1 })).toBe(null);
});
