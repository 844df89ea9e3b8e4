// SPDX-License-Identifier: Apache-2.0
// Where the brush paints: over the whole plane, by the pointer or by keys.
import { svg, type SVGTemplateResult } from "lit";
import { beginDrag } from "../input/handle";
import { plain } from "../words";
import { radiiOf, simplified, stroke } from "./brush";
import { paint, type Widget } from "./widgets";

type Point = [number, number];

export interface Painting {
  on: boolean;
  size: number; // radius as a share of the plane's width
  at: Point; // where the brush is, as shares of the plane
  open: boolean; // the last widget is a stroke that keys are painting
}

export interface PaintContext {
  painting: Painting;
  range: Point;
  size: Point; // of the drawing
  axis: string; // what the second axis is called
  color: string;
  changed: () => void;
  /** The widgets as they are now: keys come faster than the window is drawn anew. */
  list: () => Widget[];
  set: (list: Widget[], live: boolean) => void;
}

const opacity = 0.6;
const step = 0.02;

export function paintArea(c: PaintContext): SVGTemplateResult {
  const p = c.painting;
  const radius = radiiOf(p.size, c.range, c.size[1] / c.size[0]);
  const drag = (e: PointerEvent): void => {
    const box = (e.currentTarget as Element).closest("svg")!.getBoundingClientRect();
    const inside = (x: number): number => Math.max(0, Math.min(1, x));
    const place = (dx: number, dy: number): Point => [inside((e.clientX + dx - box.left) / box.width), inside(1 - (e.clientY + dy - box.top) / box.height)];
    const path = [place(0, 0)];
    lift();
    p.at = path[0];
    const before = c.list();
    beginDrag(e, () => ({
      move: (dx, dy, done) => {
        p.at = place(dx, dy);
        path.push(p.at);
        c.set([...before, stroke(path, radius, c.range, opacity, c.color)], !done);
      },
      click: () => c.set([...before, stroke(path, radius, c.range, opacity, c.color)], false),
    }));
  };
  const keyed = (e: KeyboardEvent): void => {
    const by = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as Record<string, Point>)[e.key];
    if (e.key === "Enter" || e.key === " ") c.set([...c.list(), stroke([p.at], radius, c.range, opacity, c.color)], false);
    else if (by) {
      const from = p.at;
      p.at = [0, 1].map((k) => Math.max(0, Math.min(1, from[k] + by[k] * step))) as Point;
      if (e.shiftKey) paintOn(c, radius, from);
      else c.changed();
    } else return;
    e.preventDefault();
    e.stopPropagation();
  };
  // With shift the brush goes down, and up again when the key does, or when the focus goes elsewhere: one stroke.
  const lift = (): void => {
    if (!p.open) return;
    p.open = false;
    c.set(c.list(), false);
  };
  const value = plain(c.range[0] + p.at[0] * (c.range[1] - c.range[0]));
  return svg`<rect class="paint-area" x="0" y="0" width=${c.size[0]} height=${c.size[1]} tabindex="0" role="button"
      aria-label="Brush at the value ${value}, ${c.axis} ${plain(100 * p.at[1], 2)} %; arrow keys move it, with shift they paint, Enter paints a dab"
      @pointerdown=${drag} @keydown=${keyed} @keyup=${(e: KeyboardEvent) => e.key === "Shift" && lift()} @blur=${lift} />
    <ellipse class="brush" cx=${p.at[0] * c.size[0]} cy=${(1 - p.at[1]) * c.size[1]} rx=${p.size * c.size[0]} ry=${p.size * c.size[0]} />`;
}

function paintOn(c: PaintContext, radius: Point, from: Point): void {
  const p = c.painting;
  const next = stroke([from, p.at], radius, c.range, opacity, c.color);
  const list = c.list();
  const old = p.open ? list[list.length - 1] : undefined;
  p.open = true;
  if (!old?.line || !old.radius) return c.set([...list, next], true);
  const line = simplified([...old.line, ...next.line!.slice(-1)], old.radius);
  c.set([...list.slice(0, -1), paint(line, old.radius, old.opacity, old.color)], true);
}
