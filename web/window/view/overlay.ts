// SPDX-License-Identifier: Apache-2.0
// What lies over the picture of a view: handles of planes, the line that is plotted, measurements, outlines, the place that was clicked,
// others' cursors.
import { html, nothing, svg, type TemplateResult } from "lit";
import type { App } from "../app";
import { legendHandle } from "../panels/legend";
import { placeInView } from "../camera/projection";
import { measurements, selectionOutline } from "../measure/draw";
import { planeHandles } from "../slices/handles";
import type { View } from "./view";

export function overlay(app: App, view: View): TemplateResult {
  const { width, height } = view.size;
  const { x, y } = view.area;
  return html`<svg class="overlay" viewBox="0 0 ${Math.max(width, 1)} ${Math.max(height, 1)}">
      <g transform="translate(${x} ${y})">${planeHandles(app, view)} ${line(app, view)} ${pin(app, view)} ${measurements(app, view)}</g>
      ${ruler(app, view)} ${selectionOutline(app, view)} ${cursors(app, view)}
    </svg>
    ${view.index === 0 ? legendHandle(app, view) : nothing}`;
}

/** The line as it is dragged. */
function ruler(app: App, view: View): unknown {
  const r = app.lines.ruler;
  return r && r.view === view.index ? segment(r.a, r.b) : nothing;
}

/** The line that is plotted, where it lies in the data. */
function line(app: App, view: View): unknown {
  const { from, to, ruler } = app.lines;
  if (ruler || app.tab !== "plot" || !app.panelOpen || !from || !to || !view.camera) return nothing;
  return segment(placeInView(app.state, view.camera, view.area, from), placeInView(app.state, view.camera, view.area, to));
}

function segment(a: [number, number] | null, b: [number, number] | null): unknown {
  if (!a || !b) return nothing;
  return svg`<line class="ruler" x1=${a[0]} y1=${a[1]} x2=${b[0]} y2=${b[1]} />
    <circle class="ruler-end" cx=${a[0]} cy=${a[1]} r="4" /><circle class="ruler-end" cx=${b[0]} cy=${b[1]} r="4" />`;
}

/** The clicked place goes with the camera, as it is a place of the data. */
function pin(app: App, view: View): unknown {
  const answer = app.probe.pinned?.answer;
  const p = answer?.position && view.camera ? placeInView(app.state, view.camera, view.area, answer.position) : null;
  return p ? svg`<g class="pin"><circle cx=${p[0]} cy=${p[1]} r="7" /><circle cx=${p[0]} cy=${p[1]} r="1.5" /></g>` : nothing;
}

function cursors(app: App, view: View): unknown {
  return app.session.people.cursors
    .filter((c) => c.view === view.index)
    .map((c) => {
      const x = c.at[0] * view.size.width;
      const y = c.at[1] * view.size.height;
      return svg`<g class="cursor cursor-${c.id % 4}" transform="translate(${x} ${y})"><path d="M0 0L4.5 13L7 8L12.5 6.5Z" />
        <text x="12" y="20">${c.id}</text></g>`;
    });
}
