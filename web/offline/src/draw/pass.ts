// SPDX-License-Identifier: Apache-2.0
// What everything is drawn with: the view, the lamps, and the layer that is drawn.
import type { SceneInfo, Triple } from "../data/format";
import type { Projection } from "../view/camera";
import { add, mul, sub, unit, type Vec3 } from "../view/vec";
import type { Program } from "./gl";

export interface Peel {
  before: WebGLTexture;
  hiding: WebGLTexture;
}

export interface Pass {
  projection: Projection;
  /** What places are relative to. */
  center: Vec3;
  /** Pixels of the target per pixel of the picture. */
  samples: number;
  lamps: Float32Array;
  peel: Peel | null;
  /** In motion: what costs much may be coarser. */
  moving: boolean;
  /** Lines and dots have soft edges. */
  soft: boolean;
}

export interface Drawable {
  readonly translucent: boolean;
  /** Of its most transparent parts, about. */
  readonly opacity: number;
  /** Surfaces first; edges lie on them; marks come last. */
  readonly stage: "surface" | "edges" | "marks";
  draw(pass: Pass): void;
}

export function lampsOf(scene: SceneInfo, p: Projection): Float32Array {
  const out = new Float32Array(4 * scene.lights.length);
  scene.lights.forEach((l, i) => {
    const d = l.direction as Triple;
    const world = l.follows ? sub(add(mul(p.right, d[0]), mul(p.up, d[1])), mul(p.forward, d[2])) : d;
    out.set([...unit(world), l.intensity], 4 * i);
  });
  return out;
}

/** The layer's textures take units 6 and 7. */
export function bindPass(p: Program, pass: Pass): void {
  const q = pass.projection;
  p.f("uEye", ...sub(q.eye, pass.center)), p.f("uRight", ...q.right), p.f("uUp", ...q.up), p.f("uForward", ...q.forward);
  p.f("uSize", q.width, q.height), p.f("uScale", q.scale), p.f("uNear", q.near), p.f("uFar", q.far), p.f("uSamples", pass.samples);
  p.i("uParallel", q.parallel ? 1 : 0);
  p.i("uLampCount", Math.min(8, pass.lamps.length / 4));
  p.gl.uniform4fv(p.place("uLamps"), pass.lamps.subarray(0, 32));
  p.i("uPeeling", pass.peel ? 1 : 0);
  p.texture("uBefore", 6, pass.peel?.before ?? null);
  p.texture("uHiding", 7, pass.peel?.hiding ?? null);
}

/** Lines and dots, of single samples: what covers one wholly hides what lies behind it; then comes what covers a part of one, of which the
 * largest part counts: the segments of a line meet. Several samples need no soft edges. */
export function drawMarks(p: Program, pass: Pass, whole: boolean, draw: () => void): void {
  const gl = p.gl;
  if (whole || !pass.soft) {
    p.i("uSoft", 0), draw();
    return;
  }
  p.i("uSoft", 1), draw();
  gl.enable(gl.BLEND), gl.blendEquation(gl.MAX), gl.depthMask(false);
  p.i("uSoft", 2), draw();
  gl.disable(gl.BLEND), gl.blendEquation(gl.FUNC_ADD), gl.depthMask(true);
}
