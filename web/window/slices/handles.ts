// SPDX-License-Identifier: Apache-2.0
// Handles of cutting planes over the picture: a plane is dragged along its normal, the crosshair of several planes across the view.
import { nothing, svg, type SVGTemplateResult } from "lit";
import type { App } from "../app";
import { dataBounds, placeDragged, placeDraggedAlong, placeInView } from "../camera/projection";
import { add, dot, scale, sub } from "../camera/vector";
import { beginDrag } from "../input/handle";
import type { Step, Vec3 } from "../protocol";
import type { View } from "../view/view";
import { plain } from "../words";
import { middleOf, movedTo, outline, planeOf, type Plane } from "./plane";

type Point = [number, number];

export function planeHandles(app: App, view: View): SVGTemplateResult | typeof nothing {
  const { state } = app;
  const camera = view.camera;
  if (!state?.bounds || !camera) return nothing;
  const drawn: SVGTemplateResult[] = [];
  const seen = app.selected.startsWith("show/") ? state.show[Number(app.selected.slice(5))]?.of : undefined;
  for (const step of state.steps) {
    const plane = planeNow(app, step);
    if (!plane) continue;
    if (plane.normals.length > 1) drawn.push(crosshair(app, view, step, plane));
    else if (app.selected === `steps/${step.name}` || (seen === step.name && app.tab === "steps" && app.panelOpen)) drawn.push(arrow(app, view, step, plane));
  }
  return drawn.length > 0 ? svg`${drawn}` : nothing;
}

const WORDS = ["origin", "normal", "axis", "position", "planes", "sphere", "cylinder", "box", "lasso", "quadric", "function", "field", "value", "positions"];

/** The plane of a step as it is asked for now: what was dragged a moment ago counts, drawn or not. */
function planeNow(app: App, step: Step): Plane | null {
  const words = Object.fromEntries(
    WORDS.flatMap((w) => {
      const value = app.session.word(`steps/${step.name}`, w);
      return value === undefined ? [] : [[w, value]];
    }),
  );
  return planeOf(step.operation, words, dataBounds(app.state!)!);
}

/** Moves the plane of a step: a drag from where it began, a key from where it is now. */
function mover(app: App, step: Step, start: Plane): { drag: (by: Vec3, live: boolean) => void; key: (by: Vec3) => void } {
  const move = (from: Plane, by: Vec3, live: boolean): void =>
    app.session.set(`steps/${step.name}`, movedTo(from, add(from.origin, by), dataBounds(app.state!)!), live);
  return { drag: (by, live) => move(start, by, live), key: (by) => move(planeNow(app, step) ?? start, by, false) };
}

const path = (points: (Point | null)[]): string =>
  points.some((p) => p === null) ? "" : `M${points.map((p) => `${p![0].toFixed(1)} ${p![1].toFixed(1)}`).join("L")}`;

function arrow(app: App, view: View, step: Step, plane: Plane): SVGTemplateResult {
  const camera = view.camera!;
  const bounds = dataBounds(app.state!)!;
  const normal = plane.normals[0];
  // Of the picture's size as it is seen, in lengths of the data.
  const stretch = app.state!.stretch ?? [1, 1, 1];
  const size = Math.hypot(...[0, 1, 2].map((i) => (bounds[2 * i + 1] - bounds[2 * i]) * stretch[i]));
  const reach = (0.12 * size) / Math.hypot(...normal.map((x, i) => x * stretch[i]));
  const p = placeInView(app.state, camera, view.area, plane.origin);
  const q = placeInView(app.state, camera, view.area, add(plane.origin, scale(normal, reach)));
  const frame = path(outline(plane.origin, normal, bounds).map((c) => placeInView(app.state, camera, view.area, c)));
  if (!p || !q) return svg``;
  const along = dot(normal, plane.origin);
  const move = mover(app, step, plane);
  return svg`<path class="plane-outline" d="${frame}Z" />
    <g class="handle" data-handle tabindex="0" role="slider" aria-label="Plane of ${step.name}" aria-valuenow=${Math.round((100 * dot(normal, sub(plane.origin, middleOf(bounds)))) / (reach / 0.12))}
      aria-valuetext=${plain(along)}
      @pointerdown=${(e: PointerEvent) =>
        beginDrag(e, () => {
          const taken = (e.target as Element).closest(".tip") ? add(plane.origin, scale(normal, reach)) : plane.origin;
          return { move: (dx, dy, done) => move.drag(scale(normal, placeDraggedAlong(app.state, camera, view.area, taken, normal, dx, dy)), !done) };
        })}
      @keydown=${(e: KeyboardEvent) => keyed(e, (by) => move.key(scale(normal, by * reach * 0.1)))}>
      <line x1=${p[0]} y1=${p[1]} x2=${q[0]} y2=${q[1]} class="handle-stem" />
      <circle cx=${p[0]} cy=${p[1]} r="12" class="handle-hit" /><circle cx=${p[0]} cy=${p[1]} r="5" class="handle-dot" />
      <g class="tip"><circle cx=${q[0]} cy=${q[1]} r="14" class="handle-hit" /><circle cx=${q[0]} cy=${q[1]} r="6" class="handle-dot" /></g>
    </g>`;
}

function crosshair(app: App, view: View, step: Step, plane: Plane): SVGTemplateResult {
  const camera = view.camera!;
  const bounds = dataBounds(app.state!)!;
  const p = placeInView(app.state, camera, view.area, plane.origin);
  if (!p) return svg``;
  const lines = plane.normals.map((_, i) => {
    const axis = plane.normals[i];
    const k = axis.indexOf(1);
    const end = (side: number): Vec3 => plane.origin.map((x, j) => (j === k ? bounds[2 * k + side] : x)) as Vec3;
    return svg`<path class="crosshair axis-${k}" d=${path([placeInView(app.state, camera, view.area, end(0)), placeInView(app.state, camera, view.area, end(1))])} />`;
  });
  const move = mover(app, step, plane);
  return svg`${lines}<g class="handle" data-handle tabindex="0" role="slider" aria-label="Crosshair of ${step.name}"
      aria-valuetext=${plane.origin.map((x) => plain(x)).join(", ")} aria-valuenow="0"
      @pointerdown=${(e: PointerEvent) =>
        beginDrag(e, () => ({ move: (dx, dy, done) => move.drag(placeDragged(app.state, camera, view.area, plane.origin, dx, dy), !done) }))}
      @keydown=${(e: KeyboardEvent) => {
        const step: Record<string, Point> = { ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -4], ArrowDown: [0, 4] };
        const by = step[e.key];
        if (!by) return;
        e.preventDefault();
        move.key(placeDragged(app.state, camera, view.area, plane.origin, ...by));
      }}>
      <circle cx=${p[0]} cy=${p[1]} r="16" class="handle-hit" /><circle cx=${p[0]} cy=${p[1]} r="7" class="handle-ring" />
    </g>`;
}

function keyed(e: KeyboardEvent, move: (by: number) => void): void {
  const by = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 5, PageDown: -5 }[e.key];
  if (by === undefined) return;
  e.preventDefault();
  move(by);
}
