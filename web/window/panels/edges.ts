// SPDX-License-Identifier: Apache-2.0
// Where the boxes of a graph stand and how its edges run: from step to step, beside the boxes that lie between.
import type { Step } from "../protocol";
import { place, type Placed } from "./layout";

export const cell = { w: 108, h: 58, box: 94, tall: 36, margin: 8 };

export interface Edge {
  from: string;
  to: string;
  path: string;
  middle: [number, number];
}

export interface Drawing {
  size: [number, number];
  corners: Map<string, [number, number]>; // of the boxes, top left
  edges: Edge[];
}

/** How far from the middle of a box an input is: they come in side by side, the first one on the left. */
export const inputShift = (index: number, count: number): number => (index - (count - 1) / 2) * Math.min(18, cell.box / count);

export function drawingOf(steps: Pick<Step, "name" | "from">[]): Drawing {
  const placed = place(steps);
  const at = new Map(placed.map((p) => [p.name, p]));
  const corners = new Map(placed.map((p) => [p.name, [cell.margin + p.row * cell.w + (cell.w - cell.box) / 2, p.column * cell.h + 6] as [number, number]]));
  const edges: Edge[] = [];
  for (const s of steps) {
    const inputs = s.from.filter((f) => at.has(f) && f !== s.name);
    inputs.forEach((f, i) => {
      edges.push(edge(at.get(f)!, at.get(s.name)!, corners, inputShift(i, inputs.length), placed, edges));
    });
  }
  const most = (of: (p: Placed) => number): number => Math.max(...placed.map(of), 0) + 1;
  return { size: [most((p) => p.row) * cell.w + 2 * cell.margin, most((p) => p.column) * cell.h + 4], corners, edges };
}

function edge(from: Placed, to: Placed, corners: Drawing["corners"], shift: number, placed: Placed[], others: Edge[]): Edge {
  const [x0, top] = corners.get(from.name)!;
  const [x1, y1] = corners.get(to.name)!;
  const y0 = top + cell.tall;
  const a = x0 + cell.box / 2;
  const b = x1 + cell.box / 2 + shift;
  const names = { from: from.name, to: to.name };
  const between = placed.some((p) => p.column > from.column && p.column < to.column && (p.row === from.row || p.row === to.row));
  if (!between) {
    const bend = (y1 - y0) / 2 + 4;
    return { ...names, path: `M${a} ${y0}C${a} ${y0 + bend} ${b} ${y1 - bend} ${b} ${y1}`, middle: [(a + b) / 2, (y0 + y1) / 2] };
  }
  const middle = cell.margin + (to.row < from.row ? from.row : from.row + 1) * cell.w;
  const beside = others.filter((e) => Math.abs(e.middle[0] - middle) < cell.margin);
  const gutter = middle + [0, 4, -4][beside.length % 3];
  const gap = cell.h - cell.tall;
  const [begin, end] = [y0 + gap, y1 - gap];
  const path = `M${a} ${y0}C${a} ${y0 + gap * 0.7} ${gutter} ${y0 + gap * 0.3} ${gutter} ${begin}V${end}C${gutter} ${y1 - gap * 0.3} ${b} ${y1 - gap * 0.7} ${b} ${y1}`;
  let y = (begin + end) / 2;
  while (beside.some((e) => Math.abs(e.middle[1] - y) < 14)) y -= 14;
  return { ...names, path, middle: [gutter, y] };
}
