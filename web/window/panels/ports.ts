// SPDX-License-Identifier: Apache-2.0
// Connecting by hand in the graph: an edge is drawn from below a step to an input of another one. By keys the lists of inputs do the same.
import { nothing, svg, type TemplateResult } from "lit";
import type { App } from "../app";
import { stepEntry } from "../catalog";
import { beginDrag } from "../input/handle";
import type { Step } from "../protocol";
import { slotsOf, withInput } from "../session/wiring";
import { cell, inputShift, type Drawing } from "./edges";

/** An input of a step, and where it is in the graph. */
export interface Port {
  step: string;
  index: number;
  at: [number, number];
}

/** An edge that is being drawn. */
export interface Connecting {
  from: string;
  at: [number, number]; // where the pointer is
  to: Port | null; // the input that it would go to
}

/** How far beside and above a box an edge may be let go. */
const near = 12;

/** The inputs of a step: those that take something where their edges arrive, free ones on the right of them. */
export function portsOf(app: Pick<App, "catalog">, step: Pick<Step, "name" | "operation" | "from">, [x, y]: [number, number]): Port[] {
  const slots = slotsOf(stepEntry(app.catalog, step.operation), step.from);
  const taken = Math.max(1, step.from.length);
  return slots.map((_, index) => ({ step: step.name, index, at: [x + cell.box / 2 + inputShift(index, taken), y] }));
}

/** The input under the pointer: on a box, and close to it, the nearest one of that step. A step does not take itself. */
export function portAt(ports: Port[], corners: Drawing["corners"], from: string, [x, y]: [number, number]): Port | null {
  const over = [...corners].find(
    ([name, [left, top]]) => name !== from && x > left - near && x < left + cell.box + near && y > top - near && y < top + cell.tall,
  );
  const away = (p: Port): number => Math.abs(p.at[0] - x);
  return over ? (ports.filter((p) => p.step === over[0]).sort((a, b) => away(a) - away(b))[0] ?? null) : null;
}

/** Where edges can begin and end, and the one that is being drawn. */
export function ports(app: App, steps: Step[], corners: Drawing["corners"]): (TemplateResult | typeof nothing)[] {
  const all = steps.flatMap((s) => portsOf(app, s, corners.get(s.name)!));
  const line = app.connecting;
  const begin = (s: Step) => (e: PointerEvent): void => {
    const graph = (e.currentTarget as SVGElement).ownerSVGElement!;
    beginDrag(e, () => ({
      move: (_dx, _dy, done, m) => {
        const box = graph.getBoundingClientRect();
        const at: [number, number] = [m.clientX - box.left, m.clientY - box.top];
        const to = portAt(all, corners, s.name, at);
        app.connecting = done ? null : { from: s.name, at, to };
        app.changed();
        if (done && to && m.type === "pointerup") connect(app, s.name, to);
      },
    }));
  };
  return [
    ...all.map((p) => svg`<circle class="port ${line?.to?.step === p.step && line.to.index === p.index ? "over" : ""}" aria-hidden="true" cx=${p.at[0]} cy=${p.at[1]} r="4" />`),
    ...steps.map((s) => {
      const [x, y] = corners.get(s.name)!;
      return svg`<g class="port out" aria-hidden="true" data-from=${s.name} transform="translate(${x + cell.box / 2} ${y + cell.tall})"
        @pointerdown=${begin(s)}><title>Drag to what is to take ${s.name}</title><circle class="hit" r="8" /><circle r="4" /></g>`;
    }),
    line ? drawn(line, corners) : nothing,
  ];
}

function drawn(line: Connecting, corners: Drawing["corners"]): TemplateResult {
  const [x, y] = corners.get(line.from) ?? line.at;
  const [a, b] = [x + cell.box / 2, y + cell.tall];
  const [c, d] = line.to?.at ?? line.at;
  return svg`<path class="edge drawn" d="M${a} ${b}C${a} ${b + 20} ${c} ${d - 20} ${c} ${d}" />`;
}

/** What the server objects to, as an edge that closes a circle, is read at the step that was to take the other. */
function connect(app: App, from: string, to: Port): void {
  const step = app.session.step(to.step);
  if (!step) return;
  app.select(`steps/${to.step}`);
  if (step.from[to.index] !== from) app.session.edit([{ at: `steps/${to.step}`, from: withInput(step.from, to.index, from) }]);
}
