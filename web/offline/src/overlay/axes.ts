// SPDX-License-Identifier: Apache-2.0
// Numbered axes on the outline of the box, and the orientation triad: the rules of src/render/annotate/axes.cpp.
import type { AnnotationInfo } from "../data/format";
import { cornerOf, type Bounds, type Projection, toPixel } from "../view/camera";
import { dot, type Vec3 } from "../view/vec";
import { grown, overlaps, type Rect } from "./layout";
import type { Pen } from "./pen";

type Vec2 = [number, number];

interface BoxAxis {
  axis: number;
  from: Vec3;
  to: Vec3;
  outward: Vec2;
}

function facesViewer(b: Bounds, axis: number, high: boolean, p: Projection): boolean {
  if (p.parallel) return (high ? -1 : 1) * p.forward[axis] > 1e-9;
  return high ? p.eye[axis] > b.hi[axis] : p.eye[axis] < b.lo[axis];
}

export function boxAxes(box: Bounds, p: Projection): BoxAxis[] {
  const corners: Vec2[] = [], center: Vec2 = [0, 0], axes: BoxAxis[] = [];
  for (let i = 0; i < 8; ++i) {
    const q = toPixel(p, cornerOf(box, i));
    if (!p.parallel && !(q[2] > 0)) return axes;
    corners.push([q[0], q[1]]), center[0] += q[0] / 8, center[1] += q[1] / 8;
  }
  for (let axis = 0; axis < 3; ++axis) {
    const u = (axis + 1) % 3, v = (axis + 2) % 3;
    let best = -Infinity, chosen: BoxAxis | null = null;
    for (let k = 0; k < 4; ++k) {
      const highU = (k & 1) === 1, highV = (k & 2) === 2;
      if (facesViewer(box, u, highU, p) === facesViewer(box, v, highV, p)) continue;
      const i = (highU ? 1 << u : 0) | (highV ? 1 << v : 0), j = i | (1 << axis);
      const along: Vec2 = [corners[j][0] - corners[i][0], corners[j][1] - corners[i][1]], pixels = Math.hypot(...along);
      if (pixels < 24) continue;
      const middle: Vec2 = [0.5 * (corners[i][0] + corners[j][0]) - center[0], 0.5 * (corners[i][1] + corners[j][1]) - center[1]];
      let outward: Vec2 = [along[1] / pixels, -along[0] / pixels];
      if (outward[0] * middle[0] + outward[1] * middle[1] < 0) outward = [-outward[0], -outward[1]];
      const score = 0.85 * outward[1] - 0.5 * outward[0];
      if (score > best) best = score, chosen = { axis, from: cornerOf(box, i), to: cornerOf(box, j), outward };
    }
    if (chosen) axes.push(chosen);
  }
  return axes;
}

function beside(at: Vec2, outward: Vec2, w: number, h: number): Rect {
  const reach = Math.abs(outward[0]) * 0.5 * w + Math.abs(outward[1]) * 0.5 * h;
  return { x: at[0] + outward[0] * reach - 0.5 * w, y: at[1] + outward[1] * reach - 0.5 * h, width: w, height: h };
}

interface Tick {
  at: Vec2;
  text: string;
  rect: Rect;
}

export function drawAxes(pen: Pen, a: AnnotationInfo, box: Bounds, p: Projection, font: number, taken: Rect[]): void {
  if (!a.axes || !a.axis) return;
  const free = (r: Rect) => r.x >= 2 && r.y >= 2 && r.x + r.width <= p.width - 2 && r.y + r.height <= p.height - 2 && !taken.some((t) => overlaps(t, r));
  const size = 0.88 * font, thick = Math.max(1, 0.08 * font);
  const drawn = boxAxes(box, p).map((axis) => {
    const from = toPixel(p, axis.from), to = toPixel(p, axis.to), pixels = Math.hypot(to[0] - from[0], to[1] - from[1]);
    let ticks: Tick[] = [];
    for (let wanted = Math.floor(Math.max(2, Math.min(7, pixels / (3.5 * font)))); wanted >= 1; --wanted) {
      let apart = true;
      ticks = [];
      for (const t of a.axis![axis.axis].ticks[wanted - 1]) {
        const world: Vec3 = [...axis.from];
        world[axis.axis] = t.at;
        const q = toPixel(p, world), e = pen.measure(t.text, { size }), at: Vec2 = [q[0], q[1]];
        const rect = beside([at[0] + axis.outward[0] * 0.85 * font, at[1] + axis.outward[1] * 0.85 * font], axis.outward, e.width, e.height);
        apart = apart && !ticks.some((other) => overlaps(grown(other.rect, 0.12 * font), rect));
        ticks.push({ at, text: t.text, rect });
      }
      if (apart) break;
    }
    return { axis, ticks, from, to };
  });
  for (const d of drawn) {
    const name = a.axis[d.axis.axis].name;
    if (!name) continue;
    const others = [...taken, ...drawn.filter((o) => o !== d).flatMap((o) => o.ticks.map((t) => grown(t.rect, 1)))];
    const middle: Vec2 = [0.5 * (d.from[0] + d.to[0]), 0.5 * (d.from[1] + d.to[1])], along: Vec2 = [d.to[0] - d.from[0], d.to[1] - d.from[1]], n = d.axis.outward;
    const place = (w: number, h: number): Rect | null => {
      let beyond = 0.9 * font;
      for (const t of d.ticks) {
        const cx = t.rect.x + 0.5 * t.rect.width, cy = t.rect.y + 0.5 * t.rect.height;
        const reach = Math.abs(n[0]) * 0.5 * t.rect.width + Math.abs(n[1]) * 0.5 * t.rect.height;
        beyond = Math.max(beyond, (cx - t.at[0]) * n[0] + (cy - t.at[1]) * n[1] + reach + 0.85 * font);
      }
      for (const out of [beyond, beyond * 0.75, beyond * 0.5, beyond * 1.4])
        for (const shift of [0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.42, -0.42, 0.5, -0.5]) {
          const r = beside([middle[0] + along[0] * shift + n[0] * out, middle[1] + along[1] * shift + n[1] * out], n, w, h);
          const room = { x: r.x - 0.8 * font, y: r.y - 0.3 * font, width: r.width + 1.6 * font, height: r.height + 0.6 * font };
          if (d.ticks.some((t) => overlaps(t.rect, room)) || others.some((t) => overlaps(t, r))) continue;
          if (r.x >= 2 && r.y >= 2 && r.x + r.width <= p.width - 2 && r.y + r.height <= p.height - 2) return r;
        }
      return null;
    };
    const e = pen.measure(name, { size: font });
    let r = place(e.width, e.height);
    const tight = !r || r.x < 0.6 * font || r.x + r.width > p.width - 0.6 * font;
    if (tight && Math.abs(along[1]) > 3 * Math.abs(along[0])) {
      const upright = place(e.height, e.width);
      if (upright) {
        pen.turned(name, upright.x + 0.5 * upright.width, upright.y + 0.5 * upright.height, Math.PI / 2, { size: font, halo: true });
        taken.push(upright);
        continue;
      }
    }
    if (!r) continue;
    pen.text(name, r.x, r.y, { size: font, halo: true });
    taken.push(r);
  }
  const numbers: Rect[] = [];
  for (const d of drawn) {
    const n = d.axis.outward, own: Rect[] = [];
    pen.line(d.from[0], d.from[1], d.to[0], d.to[1], thick, pen.ink, 0.9);
    const l = Math.hypot(d.to[0] - d.from[0], d.to[1] - d.from[1]) || 1, along: Vec2 = [(d.to[0] - d.from[0]) / l, (d.to[1] - d.from[1]) / l];
    for (const t of d.ticks) {
      pen.line(t.at[0], t.at[1], t.at[0] + n[0] * 0.5 * font, t.at[1] + n[1] * 0.5 * font, thick, pen.ink, 0.9);
      const share = ((t.at[0] - d.from[0]) * along[0] + (t.at[1] - d.from[1]) * along[1]) / l;
      const inward: Vec2 = Math.abs(share - 0.5) < 0.25 ? [0, 0] : share < 0.5 ? along : [-along[0], -along[1]];
      const moves: Vec2[] = [[0, 0], [inward[0] * 0.45, inward[1] * 0.45], [inward[0] * 0.9, inward[1] * 0.9], [n[0] * 0.4 + inward[0] * 0.6, n[1] * 0.4 + inward[1] * 0.6],
        [n[0] * 0.8, n[1] * 0.8], [n[0] * 1.2, n[1] * 1.2], [-0.7, 0.1], [0.7, 0.1], [-1.4, 0.3], [1.4, 0.3], [n[0] * 1.7, n[1] * 1.7]];
      for (const m of moves) {
        const r = { ...t.rect, x: t.rect.x + m[0] * font, y: t.rect.y + m[1] * font };
        const room = { x: r.x - 0.7 * font, y: r.y - 0.15 * font, width: r.width + 1.4 * font, height: r.height + 0.3 * font };
        if (!free(grown(r, 0.3 * font)) || numbers.some((o) => overlaps(o, room))) continue;
        pen.text(t.text, r.x, r.y, { size, halo: true });
        taken.push(r), own.push(r);
        break;
      }
    }
    numbers.push(...own);
  }
}

const light = ["rgb(255 107 97)", "rgb(115 217 102)", "rgb(115 158 255)"], deep = ["rgb(204 38 38)", "rgb(26 133 38)", "rgb(31 82 204)"];

export function triadPlace(height: number, font: number): Rect {
  const side = 2 * (2.7 + 1.1) * font;
  return { x: 0.6 * font, y: height - side - 0.6 * font, width: side, height: side };
}

export function drawTriad(pen: Pen, a: AnnotationInfo, p: Projection, font: number): void {
  const r = triadPlace(p.height, font), cx = r.x + 0.5 * r.width, cy = r.y + 0.5 * r.height;
  const arrows = [0, 1, 2].map((axis) => {
    const u: Vec3 = [0, 0, 0];
    u[axis] = a.stretch[axis] < 0 ? -1 : 1;
    return { axis, d: [dot(u, p.right), -dot(u, p.up)] as Vec2, depth: dot(u, p.forward) };
  }).sort((x, y) => y.depth - x.depth);
  const sum: Vec2 = [arrows.reduce((s, x) => s + x.d[0], 0), arrows.reduce((s, x) => s + x.d[1], 0)];
  for (const w of arrows) {
    const color = (a.dark ? light : deep)[w.axis], flat = Math.hypot(...w.d), tip: Vec2 = [cx + w.d[0] * 2.7 * font, cy + w.d[1] * 2.7 * font];
    let d: Vec2;
    if (flat > 0.05) {
      d = [w.d[0] / flat, w.d[1] / flat];
      const head = Math.min(0.75 * font, 0.8 * flat * 2.7 * font), neck: Vec2 = [tip[0] - d[0] * head, tip[1] - d[1] * head], s = 0.3 * font;
      pen.line(cx, cy, neck[0], neck[1], Math.max(1.5, 0.16 * font), color);
      pen.polygon([tip, [neck[0] - d[1] * s, neck[1] + d[0] * s], [neck[0] + d[1] * s, neck[1] - d[0] * s]], color);
    } else {
      const c = pen.context, l = Math.hypot(...sum);
      c.fillStyle = color, c.beginPath(), c.arc(cx, cy, 0.28 * font, 0, 2 * Math.PI), c.fill();
      d = l > 0.05 ? [-sum[0] / l, -sum[1] / l] : [-0.7071, 0.7071];
    }
    const letter = a.axis?.[w.axis].letter ?? "xyz"[w.axis];
    if (!letter || letter.length > 3) continue;
    const e = pen.measure(letter, { size: font, bold: true }), at: Vec2 = flat > 0.05 ? tip : [cx + d[0] * 0.25 * font, cy + d[1] * 0.25 * font];
    const q = beside([at[0] + d[0] * 0.05 * font, at[1] + d[1] * 0.05 * font], d, e.width, e.height);
    pen.text(letter, q.x, q.y, { size: font, bold: true, color });
  }
}
