// SPDX-License-Identifier: Apache-2.0
// Measurements as a word of the picture, where the session keeps them: "Width @ 0,0,0 1,2,3; Angle @ 0,0,0 1,0,0 1,1,0".
import type { Vec3 } from "../protocol";

export interface Measurement {
  name: string;
  points: Vec3[];
}

/** What parts the text is none of a name. */
export const plainName = (name: string): string => name.replace(/[;@\s]+/g, " ").trim();

export const keptText = (kept: Measurement[]): string =>
  kept.map((m) => `${plainName(m.name)} @ ${m.points.map((p) => p.join(",")).join(" ")}`).join("; ");

/** What is no measurement is left out. */
export function keptFrom(text: string): Measurement[] {
  return text.split(";").flatMap((part) => {
    const at = part.lastIndexOf("@");
    const points = part
      .slice(at + 1)
      .trim()
      .split(/\s+/)
      .map((p) => p.split(",").map((x) => (x === "" ? NaN : Number(x))));
    if (at < 0 || points.length < 2 || points.some((p) => p.length !== 3 || !p.every(Number.isFinite))) return [];
    return [{ name: part.slice(0, at).trim(), points: points as Vec3[] }];
  });
}
