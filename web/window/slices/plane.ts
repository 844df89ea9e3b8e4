// SPDX-License-Identifier: Apache-2.0
// The plane that the words of a `slice` or `clip` describe, and the words after it was dragged.
import { add, dot, scale, unit } from "../camera/vector";
import type { State, Vec3, Words } from "../protocol";
import { numbers, short } from "../words";

type Bounds = NonNullable<State["bounds"]>;

export interface Plane {
  origin: Vec3;
  normals: Vec3[]; // several where one step cuts along several axes through one point
  word: "position" | "origin";
}

const axes: Record<string, Vec3> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const otherShapes = ["sphere", "cylinder", "box", "lasso", "quadric", "function", "field", "value", "positions"];

export const middleOf = (b: Bounds): Vec3 => [(b[0] + b[1]) / 2, (b[2] + b[3]) / 2, (b[4] + b[5]) / 2];

/** Null where the step does not cut by a plane that can be dragged. */
export function planeOf(operation: string, words: Words, bounds: Bounds): Plane | null {
  if (operation !== "slice" && operation !== "clip") return null;
  if (otherShapes.some((w) => (words[w] ?? "") !== "")) return null;
  const origin = three(words.origin) ?? middleOf(bounds);
  const planes = words.planes ?? "none";
  if (planes !== "none") return { origin, normals: [...planes].map((c) => axes[c]), word: "origin" };
  const axis = axes[words.axis ?? "none"];
  if (!axis) return { origin, normals: [unit(three(words.normal) ?? [0, 0, 1])], word: "origin" };
  const position = words.position ? Number(words.position) : NaN;
  const middle = middleOf(bounds);
  const at = Number.isFinite(position) ? position : dot(middle, axis);
  return { origin: add(middle, scale(axis, at - dot(middle, axis))), normals: [axis], word: "position" };
}

/** The words of the plane moved so that it goes through a point; it stays within the bounds. */
export function movedTo(plane: Plane, point: Vec3, bounds: Bounds): Words {
  const inside = point.map((x, i) => Math.max(bounds[2 * i], Math.min(bounds[2 * i + 1], x))) as Vec3;
  return plane.word === "position" ? { position: short(dot(inside, plane.normals[0])) } : { origin: inside.map(short).join(",") };
}

/** The corners of the rectangle in which a plane is drawn: as large as the bounds, across the normal. */
export function outline(origin: Vec3, normal: Vec3, bounds: Bounds): Vec3[] {
  const main = normal.map(Math.abs).indexOf(Math.max(...normal.map(Math.abs)));
  const [i, j] = [(main + 1) % 3, (main + 2) % 3];
  const corner = (a: number, b: number): Vec3 => {
    const p: Vec3 = [0, 0, 0];
    p[i] = bounds[2 * i + a];
    p[j] = bounds[2 * j + b];
    // The third coordinate follows from the plane's equation.
    p[main] = origin[main] - ((p[i] - origin[i]) * normal[i] + (p[j] - origin[j]) * normal[j]) / normal[main];
    return p;
  };
  return [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
}

function three(text: string | undefined): Vec3 | null {
  const values = text ? numbers(text) : null;
  return values && values.length === 3 ? (values as Vec3) : null;
}
