// SPDX-License-Identifier: Apache-2.0
// Places for the steps of a pipeline as a graph: columns by depth, rows so that a step stands beside the first it takes from.
import type { Step } from "../protocol";

export interface Placed {
  name: string;
  column: number;
  row: number;
}

/** Steps come after those that they take from, as in pipeline files; what is taken but missing is ignored. */
export function place(steps: Pick<Step, "name" | "from">[]): Placed[] {
  const placed = new Map<string, Placed>();
  const taken = new Set<string>();
  const free = (column: number, row: number): number => {
    while (taken.has(`${column} ${row}`)) row++;
    taken.add(`${column} ${row}`);
    return row;
  };
  const visiting = new Set<string>();
  const put = (step: Pick<Step, "name" | "from">): Placed => {
    const known = placed.get(step.name);
    if (known) return known;
    visiting.add(step.name);
    const inputs = step.from.flatMap((f) => {
      const s = steps.find((x) => x.name === f);
      return s && !visiting.has(f) ? [put(s)] : [];
    });
    visiting.delete(step.name);
    const column = inputs.length > 0 ? Math.max(...inputs.map((p) => p.column)) + 1 : 0;
    const p = { name: step.name, column, row: free(column, inputs[0]?.row ?? 0) };
    placed.set(step.name, p);
    return p;
  };
  return steps.map(put);
}
