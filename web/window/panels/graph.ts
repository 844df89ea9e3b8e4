// SPDX-License-Identifier: Apache-2.0
// The pipeline as a graph, from top to bottom.
import { html, svg, type TemplateResult } from "lit";
import type { App } from "../app";
import { place } from "./layout";

const cell = { w: 112, h: 58, box: 98, tall: 36 };

export function graph(app: App): TemplateResult {
  const steps = app.state?.steps ?? [];
  const places = place(steps);
  const columns = Math.max(...places.map((p) => p.row), 0) + 1;
  const rows = Math.max(...places.map((p) => p.column), 0) + 1;
  const at = (name: string): [number, number] => {
    const p = places.find((x) => x.name === name)!;
    return [p.row * cell.w + (cell.w - cell.box) / 2, p.column * cell.h + 6];
  };
  const edges = steps.flatMap((s) =>
    s.from.filter((f) => places.some((p) => p.name === f)).map((f) => {
      const [x0, y0] = at(f);
      const [x1, y1] = at(s.name);
      const a = x0 + cell.box / 2;
      const b = x1 + cell.box / 2;
      const bend = (y1 - y0 - cell.tall) / 2 + 4;
      return svg`<path class="edge" d="M${a} ${y0 + cell.tall}C${a} ${y0 + cell.tall + bend} ${b} ${y1 - bend} ${b} ${y1}" />`;
    }),
  );
  const nodes = steps.map((s) => {
    const [x, y] = at(s.name);
    const chosen = app.selected === `steps/${s.name}`;
    const seen = app.state!.show.some((v) => v.of === s.name);
    const choose = (): void => app.select(`steps/${s.name}`);
    return svg`<g class="node ${chosen ? "chosen" : ""} ${seen ? "seen" : ""}" tabindex="0" role="button" aria-pressed=${chosen ? "true" : "false"}
      aria-label="${s.name}: ${s.operation}${s.from.length > 0 ? ` of ${s.from.join(" and ")}` : ""}${seen ? ", shown" : ""}"
      transform="translate(${x} ${y})" @click=${choose} @keydown=${(e: KeyboardEvent) => {
        if (e.key !== "Enter" && e.key !== " ") return;
        e.preventDefault();
        choose();
      }}>
      <rect width=${cell.box} height=${cell.tall} rx="6" /><text x=${cell.box / 2} y="15">${clip(s.name)}</text>
      <text class="quiet" x=${cell.box / 2} y="29">${clip(s.operation === s.name ? (s.kind ?? "") : s.operation)}</text></g>`;
  });
  return html`<div class="graph"><svg width=${columns * cell.w} height=${rows * cell.h + 4} viewBox="0 0 ${columns * cell.w} ${rows * cell.h + 4}" role="group" aria-label="The pipeline as a graph">${edges}${nodes}</svg></div>`;
}

const clip = (s: string): string => (s.length > 15 ? `${s.slice(0, 14)}…` : s);
