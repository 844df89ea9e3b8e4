// SPDX-License-Identifier: Apache-2.0
// The catalogue of everything that can be requested (`sightglass ops --json`), and looking things up in it.

export interface Schema {
  type?: string | (string | null)[];
  description?: string;
  default?: unknown;
  enum?: (string | null)[];
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  minItems?: number;
  maxItems?: number;
  items?: Schema;
  unit?: string;
  field?: { on: string[]; of: string[] };
}

export interface Entry {
  name: string;
  kind: string;
  sentence: string;
  family?: string;
  inputs?: [number, number];
  takes?: string[][];
  makes?: { same: string[]; else: string[]; parts: boolean };
  params: { properties: Record<string, Schema>; required?: string[] };
}

export interface Catalog {
  sources: Entry[];
  operations: Entry[];
  show: Entry[];
  readers?: Entry[];
  read: Entry;
  camera: Entry;
  picture: Entry;
  lights: Entry[];
  environments: Entry[];
  nodes: Entry[];
}

const noEntry: Entry = { name: "", kind: "", sentence: "", params: { properties: {} } };
export const noCatalog: Catalog = { sources: [], operations: [], show: [], read: noEntry, camera: noEntry, picture: noEntry, lights: [], environments: [], nodes: [] };

export const stepEntry = (catalog: Catalog, operation: string): Entry | undefined =>
  operation === "read"
    ? catalog.read
    : (catalog.operations.find((o) => o.name === operation) ?? catalog.sources.find((o) => o.name === operation));

export const showEntry = (catalog: Catalog, kind: string): Entry | undefined => catalog.show.find((o) => o.name === kind);

export const named = (entries: Entry[], name: string): Entry | undefined => entries.find((e) => e.name === name);

/** Whether it must be told a file, which a window cannot choose. */
export const wantsFile = (entry: Entry): boolean => (entry.params.required ?? []).some((w) => entry.params.properties[w]?.unit === "file");

/** Operations and sources that match all words of the query, those whose name begins with it first. */
export function search(entries: Entry[], query: string): Entry[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const rank = (e: Entry): number => {
    const name = e.name.replaceAll("_", " ");
    const text = `${name} ${e.name} ${e.family ?? ""} ${e.sentence}`.toLowerCase();
    if (!words.every((w) => text.includes(w))) return -1;
    if (words.length === 0) return 4;
    if (name.startsWith(words[0])) return 0;
    if (name.includes(words[0])) return 1;
    return e.sentence.toLowerCase().startsWith(words[0]) ? 2 : 3;
  };
  return entries
    .map((entry) => ({ entry, rank: rank(entry) }))
    .filter((x) => x.rank >= 0)
    .sort((a, b) => a.rank - b.rank)
    .map((x) => x.entry);
}

/** Whether an operation takes a mesh of this kind as its first input; unknown kinds are given the benefit of the doubt. */
export function takesKind(entry: Entry, kind: string | undefined): boolean {
  if (!kind || kind === "collection" || !entry.takes || entry.takes.length === 0) return true;
  return entry.takes[0].includes(kind);
}
