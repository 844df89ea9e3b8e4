// SPDX-License-Identifier: Apache-2.0
// The pipeline as a graph, from top to bottom: steps that are chosen, edges into which a step is put, and ports between which
// edges are drawn.
import { html, svg, type TemplateResult } from "lit";
import type { App } from "../app";
import type { Step } from "../protocol";
import { cell, drawingOf, type Edge } from "./edges";
import { ports } from "./ports";

export function graph(app: App): TemplateResult {
  const steps = app.state?.steps ?? [];
  const { size, corners, edges } = drawingOf(steps);
  return html`<div class="graph"><svg width=${size[0]} height=${size[1]} viewBox="0 0 ${size[0]} ${size[1]}" role="group" aria-label="The pipeline as a graph">
    ${edges.map((e) => svg`<path class="edge" d=${e.path} />`)}
    ${steps.map((s) => node(app, s, corners.get(s.name)!))}
    ${app.state?.may_edit ? [...edges.map((e) => between(app, e)), ...ports(app, steps, corners)] : []}</svg></div>`;
}

function node(app: App, s: Step, [x, y]: [number, number]): TemplateResult {
  const chosen = app.selected === `steps/${s.name}`;
  const seen = app.state!.show.some((v) => v.of === s.name);
  return svg`<g class="node ${chosen ? "chosen" : ""} ${seen ? "seen" : ""}" tabindex="0" role="button" aria-pressed=${chosen ? "true" : "false"}
    aria-label="${s.name}: ${s.operation}${s.from.length > 0 ? ` of ${s.from.join(" and ")}` : ""}${seen ? ", shown" : ""}"
    transform="translate(${x} ${y})" @click=${() => app.select(`steps/${s.name}`)} @keydown=${onKey(() => app.select(`steps/${s.name}`))}>
    <rect width=${cell.box} height=${cell.tall} rx="6" /><text x=${cell.box / 2} y="15">${clip(s.name)}</text>
    <text class="quiet" x=${cell.box / 2} y="29">${clip(s.operation === s.name ? (s.kind ?? "") : s.operation)}</text></g>`;
}

function between(app: App, e: Edge): TemplateResult {
  const insert = (): void => app.insert(e.from, [`steps/${e.to}`]);
  return svg`<g class="insert" tabindex="0" role="button" aria-label="Insert between ${e.from} and ${e.to}" transform="translate(${e.middle[0]} ${e.middle[1]})"
    @click=${insert} @keydown=${onKey(insert)}><title>Insert between ${e.from} and ${e.to}</title><circle class="hit" r="10" /><circle r="6" /><path d="M-3 0h6M0 -3v6" /></g>`;
}

/** What a button does, from the keyboard. */
const onKey = (act: () => void) => (e: KeyboardEvent): void => {
  if (e.key !== "Enter" && e.key !== " ") return;
  e.preventDefault();
  act();
};

const clip = (s: string): string => (s.length > 13 ? `${s.slice(0, 12)}…` : s);
