// SPDX-License-Identifier: Apache-2.0
// How the steps of a pipeline hang together, and the edits that connect them otherwise.
import type { Entry } from "../catalog";
import type { Edit, State, Step } from "../protocol";

type Linked = Pick<Step, "name" | "from">;

/** The step and all that hang on it, near or far. Steps stand behind those that they take. */
export function hangingOn(steps: Linked[], name: string): Set<string> {
  const names = new Set([name]);
  for (const s of steps) if (s.from.some((f) => names.has(f))) names.add(s.name);
  return names;
}

/** The steps that one may take: any that does not hang on it. */
export function mayTake<S extends Linked>(steps: S[], name: string): S[] {
  const hanging = hangingOn(steps, name);
  return steps.filter((s) => !hanging.has(s.name));
}

/** An input of a step: what it takes there, "" for nothing, and whether nothing would do. */
export interface Slot {
  takes: string;
  optional: boolean;
}

/** The inputs of a step as its operation has them; where there is room for one more, an empty one at the end. */
export function slotsOf(entry: Pick<Entry, "inputs"> | undefined, from: string[]): Slot[] {
  const [least, most] = entry?.inputs ?? [from.length, from.length];
  const count = Math.max(least, from.length);
  const room = most < 0 || count < most ? 1 : 0;
  return Array.from({ length: count + room }, (_, i) => ({ takes: from[i] ?? "", optional: i >= least || from.length > least }));
}

/** The inputs with another one in a place; "" takes that one away. */
export function withInput(from: string[], index: number, takes: string): string[] {
  const next = [...from];
  if (takes === "") next.splice(index, 1);
  else next[index] = takes;
  return next;
}

/** Where something takes a step: the place of an edit, and a name for the person. */
export interface Taker {
  place: string;
  name: string;
}

export function takersOf(s: Pick<State, "steps" | "show" | "scene">, step: string): Taker[] {
  return [
    ...s.steps.filter((x) => x.from.includes(step)).map((x) => ({ place: `steps/${x.name}`, name: x.name })),
    ...s.show.flatMap((x, i) => (x.of === step ? [{ place: `show/${i}`, name: `what is shown as ${x.kind}` }] : [])),
    ...s.scene.filter((x) => x.copies_of === step).map((x) => ({ place: `scene/${x.name}`, name: `copies in ${x.name}` })),
  ];
}

/** Whether a step can go: one that takes nothing only while no other takes it, and not the last one. */
export const canGo = (s: State, step: Step): boolean =>
  s.steps.length > 1 && (step.from.length > 0 || takersOf(s, step.name).every((t) => t.place.startsWith("show/")));

/** Takes a step away. What took it takes its first input; so does what is shown of it, where that is of one kind and not seen yet. */
export function removal(s: State, step: Step): Edit {
  const input = s.steps.find((x) => x.name === step.from[0]);
  if (!input) return { remove: `steps/${step.name}` };
  const looksAlike = input.kind === step.kind && !s.show.some((x) => x.of === input.name);
  const join = takersOf(s, step.name).map((t) => t.place);
  return { remove: `steps/${step.name}`, join: join.filter((place) => looksAlike || !place.startsWith("show/")) };
}
