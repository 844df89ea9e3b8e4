// SPDX-License-Identifier: Apache-2.0
// Which control a parameter gets, from its schema alone.
import type { Schema } from "../catalog";

export type Kind =
  | "switch" // true or false
  | "number" // a number, with a slider where both ends of its range are close enough to drag between
  | "choice" // one of several words
  | "choices" // some of several words
  | "field" // a field of the data
  | "fields" // several fields
  | "color"
  | "map" // a colour map
  | "opacity" // an opacity curve
  | "vector" // a fixed count of numbers
  | "ends" // the two ends of a range of values
  | "numbers" // any count of numbers
  | "texts" // any count of words
  | "file" // a path, as the server sees it
  | "text"; // free text: a name, an expression, a title

/** Units that say: the value is a colour. Three numbers may be those of the screen, or in proportion to the light. */
export const isLinearColor = (s: Schema): boolean => s.unit === "linear color";
export const isColor = (s: Schema): boolean => s.unit === "color" || isLinearColor(s);
/** A list of words whose sentence begins with fields is one of fields: "Point fields to advect", "Names of the fields to leave out". */
const listsFields = (s: Schema): boolean => /^(\w+ ){0,3}fields\b/i.test(s.description ?? "");
// A choice or a field, an expression of fields, or a column of a table: free text with the fields suggested.
const fieldWords = new Set(["size_by", "second", "expr", "function", "x", "y", "z", "color"]);

export const typesOf = (s: Schema): string[] => (Array.isArray(s.type) ? s.type : [s.type ?? "string"]).map((t) => t ?? "null");

/** Words that may be given, without the null that stands for "chosen from the data". */
export const choicesOf = (s: Schema): string[] => (s.enum ?? s.items?.enum ?? []).filter((x): x is string => x !== null);

export function kindOf(name: string, s: Schema): Kind {
  const types = typesOf(s);
  if (s.field) return "field";
  if (s.enum) return "choice";
  if (isColor(s)) return "color";
  if (types.includes("boolean")) return "switch";
  if (types.includes("number") || types.includes("integer")) return "number";
  if (types.includes("array")) {
    const items = s.items ? typesOf(s.items) : ["string"];
    if (items.includes("string")) return s.items?.enum ? "choices" : name === "fields" || listsFields(s) ? "fields" : "texts";
    if (name === "range" && s.unit === "@field") return "ends";
    return s.minItems !== undefined && s.minItems === s.maxItems ? "vector" : "numbers";
  }
  if (s.unit === "file" || s.unit === "new file") return "file";
  if (name === "map") return "map";
  if (name === "opacity" || name === "second_opacity") return "opacity";
  return "text";
}

/** Whether a text may also name a field, so that the fields are suggested. */
export const suggestsFields = (name: string): boolean => fieldWords.has(name);

/** The two ends of a slider, or null where a slider would be useless: an open range or one of many magnitudes. */
export function sliderRange(s: Schema, fieldRange?: [number, number] | null): { min: number; max: number; step: number } | null {
  const integer = typesOf(s).includes("integer");
  const low = s.minimum ?? s.exclusiveMinimum;
  const high = s.maximum ?? s.exclusiveMaximum;
  let min = low;
  let max = high;
  if (s.unit === "@field" && fieldRange && fieldRange[1] > fieldRange[0]) [min, max] = fieldRange;
  if (s.unit === "deg" && min === undefined && max === undefined) [min, max] = [-180, 180];
  if (min === undefined || max === undefined || !(max > min)) return null;
  if (s.unit !== "@field" && max - min > 1000) return null;
  return { min, max, step: integer ? 1 : (max - min) / 500 };
}

/** The two ends of a slider of magnitudes: of what is above 0 and has a default, a factor such as the brightness of a light. */
export function factorRange(s: Schema): { min: number; max: number } | null {
  const d = s.default;
  if (typesOf(s).includes("integer") || s.exclusiveMinimum !== 0 || typeof d !== "number" || !(d > 0) || s.maximum === undefined) return null;
  return { min: d / 100, max: Math.min(s.maximum, d * 100) };
}

/** A default as people read it. */
export function defaultText(s: Schema): string {
  const d = s.default;
  if (d === undefined || d === null || d === "") return "";
  if (Array.isArray(d)) return d.join(",");
  return String(d);
}
