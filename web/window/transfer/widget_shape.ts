// SPDX-License-Identifier: Apache-2.0
// One widget over the plane: its shape, its grips, what the pointer and the keys do to it.
import { nothing, svg, type SVGTemplateResult } from "lit";
import { hexOf } from "../controls/color_text";
import { beginDrag } from "../input/handle";
import { plain } from "../words";
import { corners, gripped, type Grip, type Widget } from "./widgets";

export interface ShapeContext {
  range: [number, number];
  size: [number, number]; // of the drawing
  chosen: boolean;
  choose: () => void;
  /** The widget as it is now: keys come faster than the window is drawn anew. */
  now: () => Widget;
  put: (next: Widget, live: boolean) => void;
  remove: () => void;
}

type Point = [number, number];

export function widgetShape(c: ShapeContext, w: Widget): SVGTemplateResult {
  const px = (p: Point): Point => [p[0] * c.size[0], (1 - p[1]) * c.size[1]];
  const corner = corners(w, c.range).map(px);
  const drag = (grip: Grip) => (e: PointerEvent): void => {
    const box = (e.currentTarget as Element).closest("svg")!.getBoundingClientRect();
    c.choose();
    beginDrag(e, () => ({ move: (dx, dy, done) => c.put(gripped(w, grip, dx / box.width, -dy / box.height, c.range), !done) }));
  };
  const keyed = (e: KeyboardEvent): void => {
    const by = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as Record<string, Point>)[e.key];
    if (e.key === "Delete" || e.key === "Backspace") c.remove();
    else if (by) c.put(gripped(c.now(), e.shiftKey ? (by[0] !== 0 ? "high" : "top") : "body", by[0] * 0.02, by[1] * 0.02, c.range), false);
    else return;
    e.preventDefault();
  };
  const label = `${w.shape} from ${plain(w.low)} to ${plain(w.high)}; arrow keys move it, with shift they ${w.line ? "change its brush" : "resize it"}`;
  const path = (d: string): SVGTemplateResult => svg`<path class=${w.line ? "band" : ""} transform=${w.line ? scaling(c, w) : nothing} tabindex="0" role="button" aria-label=${label} d=${d}
      fill=${w.line ? "none" : fillOf(w)} fill-opacity=${strength(w)} stroke=${w.line ? fillOf(w) : nothing} stroke-opacity=${w.line ? strength(w) : nothing}
      @pointerdown=${drag("body")} @keydown=${keyed} @focus=${c.choose} />`;
  return svg`<g class="widget ${c.chosen ? "chosen" : ""}">
    ${w.line ? svg`${path(bandPath(c, w, px))}<path class="line" aria-hidden="true" d=${pathOf(linePoints(c, w, px))} />` : path(outline(w, corner))}
    ${c.chosen && !w.line ? grips(w, corner).map(([g, p]) => svg`<circle class="grip" cx=${p[0]} cy=${p[1]} r="5" @pointerdown=${drag(g)} />`) : nothing}
  </g>`;
}

const fillOf = (w: Widget): string => (w.color === "map" ? "#999999" : hexOf(w.color));
const strength = (w: Widget): number => 0.25 + 0.5 * w.opacity;
const pathOf = (points: Point[]): string => `M${points.map((p) => p.map((q) => q.toFixed(1)).join(" ")).join("L")}`;
const middle = (a: Point, b: Point): Point => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];

function outline(w: Widget, corner: Point[]): string {
  if (w.shape !== "ellipse") return `${pathOf(corner)}Z`;
  const [rx, ry] = [Math.abs(corner[1][0] - corner[0][0]) / 2, Math.abs(corner[0][1] - corner[2][1]) / 2].map((r) => r.toFixed(1));
  const [left, right] = [middle(corner[0], corner[3]), middle(corner[1], corner[2])];
  const arc = (to: Point): string => `A${rx} ${ry} 0 0 1 ${to[0].toFixed(1)} ${to[1].toFixed(1)}`;
  return `${pathOf([left])}${arc(right)}${arc(left)}Z`;
}

function grips(w: Widget, corner: Point[]): [Grip, Point][] {
  if (w.shape === "triangle")
    return [["low", corner[2]], ["high", corner[1]], ["top", middle(corner[1], corner[2])], ["bottom", corner[0]]];
  return [
    ["low", middle(corner[0], corner[3])],
    ["high", middle(corner[1], corner[2])],
    ["top", middle(corner[2], corner[3])],
    ["bottom", middle(corner[0], corner[1])],
  ];
}

const linePoints = (c: ShapeContext, w: Widget, px: (p: Point) => Point): Point[] => {
  const points = w.line!.map(([v, s]) => px([(v - c.range[0]) / (c.range[1] - c.range[0] || 1), s]));
  return points.length > 1 ? points : [points[0], points[0]]; // a dab: round ends alone
};

/** A line as wide as the brush, which is round before it is stretched along both axes. */
const scaling = (c: ShapeContext, w: Widget): string => `scale(${radii(c, w).join(" ")})`;
const radii = (c: ShapeContext, w: Widget): Point => [(w.radius![0] / Math.abs(c.range[1] - c.range[0] || 1)) * c.size[0], w.radius![1] * c.size[1]];
function bandPath(c: ShapeContext, w: Widget, px: (p: Point) => Point): string {
  const [rx, ry] = radii(c, w);
  return `M${linePoints(c, w, px).map(([x, y]) => `${(x / rx).toFixed(3)} ${(y / ry).toFixed(3)}`).join("L")}`;
}
