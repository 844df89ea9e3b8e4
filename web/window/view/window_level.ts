// SPDX-License-Identifier: Apache-2.0
// Window and level, as at a scanner's console: across widens the range of colours, upwards lowers its middle.
import type { App } from "../app";
import type { Drag } from "../input/pointer";
import { short } from "../words";
import type { View } from "./view";

let start: { at: string; range: [number, number]; whole: number } | null = null;

/** The range after a drag by shares of the picture, dx to the right and dy downwards. */
export function levelled(range: [number, number], whole: number, dx: number, dy: number): [number, number] {
  const width = Math.max((range[1] - range[0]) * Math.exp(dx * 3), whole * 1e-4);
  const middle = (range[0] + range[1]) / 2 + dy * Math.max(range[1] - range[0], whole * 0.1);
  return [middle - width / 2, middle + width / 2];
}

export function levelDrag(app: App, view: View, drag: Drag, phase: "begin" | "drag" | "end"): boolean {
  if (phase === "begin") {
    const index = coloured(app);
    const t = index >= 0 ? app.session.shown(index)?.transfer : null;
    start = t ? { at: `show/${index}`, range: [...t.range], whole: Math.abs(t.histogram ? t.histogram.range[1] - t.histogram.range[0] : t.range[1] - t.range[0]) || 1 } : null;
    if (!start) app.say("Nothing here is coloured by a field");
    return start !== null;
  }
  if (!start) return false;
  const dx = (drag.at[0] - drag.from[0]) / view.size.width;
  const dy = (drag.at[1] - drag.from[1]) / view.size.height;
  const r = levelled(start.range, start.whole, dx, dy);
  app.session.set(start.at, { range: r.map(short).join(",") }, phase === "drag");
  return true;
}

/** What is selected if a field colours it, else the first way to show that a field colours. */
export function coloured(app: App): number {
  const show = app.state?.show ?? [];
  const chosen = app.selected.startsWith("show/") ? Number(app.selected.slice(5)) : -1;
  if (show[chosen]?.transfer) return chosen;
  return show.findIndex((s) => s.transfer);
}
