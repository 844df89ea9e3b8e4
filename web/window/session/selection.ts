// SPDX-License-Identifier: Apache-2.0
// What is selected once another state has come: what was just added, as that is what one wants to adjust, or what is left.
import type { State } from "../protocol";

/** Of show/N, steps/NAME, lights/N, environment, scene/NAME, picture. */
export function selectionAfter(selected: string, state: State, before: State | null): string {
  return (before && added(state, before)) ?? (isThere(selected, state) ? selected : insteadOf(selected, state));
}

function added(now: State, before: State): string | null {
  const step = now.steps.length > before.steps.length ? now.steps.find((s) => !before.steps.some((b) => b.name === s.name)) : undefined;
  if (step) return `steps/${step.name}`;
  if (now.show.length > before.show.length) return `show/${now.show.length - 1}`;
  if (now.lights.length > before.lights.length) return `lights/${now.lights.length - 1}`;
  const node = now.scene.length > before.scene.length ? now.scene.find((n) => !before.scene.some((b) => b.name === n.name)) : undefined;
  return node ? `scene/${node.name}` : null;
}

function isThere(at: string, s: State): boolean {
  const name = at.slice(at.indexOf("/") + 1);
  if (at.startsWith("show/")) return Number(name) < s.show.length;
  if (at.startsWith("steps/")) return s.steps.some((x) => x.name === name);
  if (at.startsWith("lights/")) return Number(name) < s.lights.length;
  if (at.startsWith("scene/")) return s.scene.some((x) => x.name === name);
  return true;
}

function insteadOf(at: string, s: State): string {
  if (at.startsWith("lights/") && s.lights.length > 0) return `lights/${s.lights.length - 1}`;
  if (at.startsWith("show/")) return s.show.length > 0 ? `show/${s.show.length - 1}` : "picture";
  return "show/0";
}
