// SPDX-License-Identifier: Apache-2.0
// The legend is part of the picture; over it lies a handle that moves it to another side of the picture and opens its words.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { showEntry } from "../catalog";
import { form } from "../controls/form";
import { beginDrag } from "../input/handle";
import { coloured } from "../view/window_level";
import type { View } from "../view/view";
import { dialog } from "./dialog";

type Side = "right" | "left" | "top" | "bottom";
const sides: Side[] = ["left", "right", "top", "bottom"];
export const legendWords = ["legend", "legend_title", "legend_unit", "legend_ticks", "legend_count", "legend_format", "legend_place", "legend_bar"];

/** The side of the picture that is nearest to a place, in shares of its size. */
export function sideAt(x: number, y: number): Side {
  const far: [Side, number][] = [["left", x], ["right", 1 - x], ["top", y], ["bottom", 1 - y]];
  return far.reduce((a, b) => (b[1] < a[1] ? b : a))[0];
}

export function legendHandle(app: App, view: View): TemplateResult | typeof nothing {
  const index = coloured(app);
  if (index < 0 || app.session.word(`show/${index}`, "legend") === "false") return nothing;
  const at = `show/${index}`;
  const side = (app.session.word(at, "legend_place") ?? "right") as Side;
  const put = (to: string, live: boolean): void => app.session.set(at, { legend_place: to === "right" ? null : to }, live);
  return html`<button
    class="legend-handle ${side}" data-handle title="Drag the legend to another side; click to edit it"
    aria-label="Legend, at the ${side}: Enter edits it, arrow keys move it"
    @pointerdown=${(e: PointerEvent) =>
      beginDrag(e, () => ({
        move: (_dx, _dy, done, m) => {
          const box = view.element.getBoundingClientRect();
          const to = sideAt((m.clientX - box.left) / box.width, (m.clientY - box.top) / box.height);
          if (done || to !== (app.session.word(at, "legend_place") ?? "right")) put(to, !done);
        },
        click: () => open(app, index),
      }))}
    @keydown=${(e: KeyboardEvent) => {
      const to = { ArrowLeft: "left", ArrowRight: "right", ArrowUp: "top", ArrowDown: "bottom" }[e.key];
      if (to) put(to, false);
      else if (e.key === "Enter" || e.key === " ") open(app, index);
      else return;
      e.preventDefault();
    }}><span aria-hidden="true">⋮⋮</span></button>`;
}

function open(app: App, index: number): void {
  app.selected = `show/${index}`;
  app.dialog = "legend";
  app.changed();
}

export function legendDialog(app: App): TemplateResult {
  const index = coloured(app);
  const entry = showEntry(app.catalog, app.session.shown(index)?.kind ?? "");
  if (!entry) return html``;
  return dialog(app, "Legend", html`${form(app, { at: `show/${index}`, entry, only: legendWords })}
    <p class="quiet">Places: ${sides.join(", ")}. The handle at the legend can be dragged there, too.</p>`);
}
