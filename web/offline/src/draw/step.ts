// SPDX-License-Identifier: Apache-2.0
// What is shown at one time, on the graphics card.
import type { ArrayStore } from "../data/arrays";
import type { AnnotationInfo, ItemInfo, SceneInfo } from "../data/format";
import type { Bounds, Projection } from "../view/camera";
import { cornerOf } from "../view/camera";
import { sub, transform, type Vec3 } from "../view/vec";
import { Volume } from "../volume/volume";
import { Coloring } from "./coloring";
import type { GL } from "./gl";
import { Glyphs } from "./glyphs";
import { Lines, loadLines } from "./lines";
import type { Drawable } from "./pass";
import { Points } from "./points";
import type { Scale } from "./scales";
import { Surface } from "./surfaces";

export interface Step {
  annotation: AnnotationInfo;
  box: Bounds | null;
  bounds: Bounds;
  drawables: Drawable[];
  volumes: Volume[];
  time?: number;
}

function include(b: Bounds, p: Vec3): void {
  for (let a = 0; a < 3; ++a) b.lo[a] = Math.min(b.lo[a], p[a]), b.hi[a] = Math.max(b.hi[a], p[a]);
}

function includeItem(b: Bounds, item: ItemInfo): void {
  if (item.kind === "volume") {
    const m = item.to_u, det = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
    const back = [m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4], m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6],
      m[2] * m[3] - m[0] * m[5], m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]].map((x) => x / det);
    for (let i = 0; i < 8; ++i) {
      const p = transform(back, cornerOf({ lo: item.lo, hi: item.hi }, i));
      include(b, [p[0] + item.origin[0], p[1] + item.origin[1], p[2] + item.origin[2]]);
    }
    return;
  }
  const q = "places" in item ? item.places : item.positions;
  const reach = "places" in item && !item.in_pixels ? item.largest * 32767 : 0;
  for (let i = 0; i < 8; ++i)
    include(b, [0, 1, 2].map((a) => q.origin[a] + q.lo[a] + (i >> a & 1 ? q.size[a] + reach : -reach)) as Vec3);
}

export const boxOf = (a: AnnotationInfo): Bounds | null => (a.box ? { lo: a.box.slice(0, 3) as Vec3, hi: a.box.slice(3) as Vec3 } : null);

export function boundsOf(items: ItemInfo[], a: AnnotationInfo): Bounds {
  const b: Bounds = { lo: [Infinity, Infinity, Infinity], hi: [-Infinity, -Infinity, -Infinity] }, box = boxOf(a);
  if (box) include(b, box.lo), include(b, box.hi);
  for (const item of items) includeItem(b, item);
  return b.lo[0] <= b.hi[0] ? b : { lo: [-0.5, -0.5, -0.5], hi: [0.5, 0.5, 0.5] };
}

export async function loadStep(gl: GL, scene: SceneInfo, n: number, center: Vec3, scales: Scale[], store: ArrayStore): Promise<Step> {
  const { items, annotation, time } = scene.steps[n], volumes: Volume[] = [], drawables: Drawable[] = [];
  const loaded = await Promise.all(items.map((item): Promise<Drawable | Volume> => {
    switch (item.kind) {
      case "surface": return Surface.load(gl, item, center, scales, store);
      case "lines": return loadLines(gl, item, center, scales, store);
      case "points": case "discs": return Points.load(gl, item, center, scales, store);
      case "volume": return Volume.load(gl, item, center, scales, store);
      default: return Glyphs.load(gl, item, center, scales, store);
    }
  }));
  for (const item of loaded) {
    if (item instanceof Volume) volumes.push(item);
    else drawables.push(item);
  }
  return { annotation, box: boxOf(annotation), bounds: boundsOf(items, annotation), drawables, volumes, time };
}

/** The edges of the box that do not lie in front of what is shown: those with a face turned away from the viewer. */
export class BoxBehind {
  private key = -1;
  private lines: Lines | null = null;
  private coloring: Coloring | null = null;

  constructor(private readonly gl: GL, private readonly box: Bounds, private readonly center: Vec3) {}
  async load(store: ArrayStore): Promise<void> {
    this.coloring = await Coloring.load({ kind: "constant", rgba: [0.4341536, 0.4341536, 0.4620770, 1] }, [], store);
  }
  at(p: Projection): Drawable | null {
    const away = (axis: number, high: boolean) => {
      if (p.parallel) return (high ? -1 : 1) * -p.forward[axis] >= 0;
      return high ? p.eye[axis] <= this.box.hi[axis] : p.eye[axis] >= this.box.lo[axis];
    };
    let key = 0;
    for (let a = 0; a < 3; ++a) key |= (away(a, false) ? 1 << (2 * a) : 0) | (away(a, true) ? 2 << (2 * a) : 0);
    if (key === this.key || !this.coloring) return this.lines;
    const from: number[] = [], to: number[] = [];
    for (let c = 0; c < 8; ++c)
      for (let a = 0; a < 3; ++a) {
        const u = (a + 1) % 3, v = (a + 2) % 3;
        if (c >> a & 1 || !(this.box.hi[a] > this.box.lo[a])) continue;
        if (!away(u, (c >> u & 1) === 1) && !away(v, (c >> v & 1) === 1)) continue;
        from.push(...sub(cornerOf(this.box, c), this.center)), to.push(...sub(cornerOf(this.box, c | (1 << a)), this.center));
      }
    this.key = key;
    this.lines = from.length === 0 ? null : new Lines(this.gl, { width: 1, opacity: 1, lit: false, material: [1, 0, 0, 1], contrast: "none", halo: 0, haloColor: [0, 0, 0], inPixels: false },
      this.coloring, { from: Float32Array.from(from), to: Float32Array.from(to) });
    return this.lines;
  }
}
