// SPDX-License-Identifier: Apache-2.0
// The camera as in src/scene/camera.h, and how it is moved.
import type { CameraInfo } from "../data/format";
import { add, cross, dot, len, mul, sub, turned, unit, type Vec3 } from "./vec";

export interface Bounds {
  lo: Vec3;
  hi: Vec3;
}
export const centerOf = (b: Bounds): Vec3 => mul(add(b.lo, b.hi), 0.5);
export const diagonalOf = (b: Bounds) => len(sub(b.hi, b.lo));
export const cornerOf = (b: Bounds, i: number): Vec3 => [i & 1 ? b.hi[0] : b.lo[0], i & 2 ? b.hi[1] : b.lo[1], i & 4 ? b.hi[2] : b.lo[2]];

export interface Axes {
  right: Vec3;
  up: Vec3;
  forward: Vec3;
}

export function viewAxes(towards: Vec3, above: Vec3): Axes {
  const forward = unit(towards);
  let right = cross(forward, unit(above));
  if (!(len(right) > 1e-9)) {
    const a = forward.map(Math.abs);
    right = cross(forward, a[1] <= a[0] && a[1] <= a[2] ? [0, 1, 0] : a[2] <= a[0] ? [0, 0, 1] : [1, 0, 0]);
  }
  right = unit(right);
  return { right, up: cross(right, forward), forward };
}

/** From the world to pixels of an area; y down. */
export interface Projection extends Axes {
  width: number;
  height: number;
  parallel: boolean;
  eye: Vec3;
  scale: number;
  near: number;
  far: number;
}

export class Camera {
  position: Vec3;
  target: Vec3;
  up: Vec3;
  angle: number;
  parallel: boolean;
  height: number;

  constructor(c: CameraInfo) {
    this.position = [...c.position], this.target = [...c.target], this.up = [...c.up];
    this.angle = c.angle, this.parallel = c.parallel, this.height = c.height;
  }
  set(other: Camera): void {
    Object.assign(this, other);
  }
  copy(): Camera {
    return new Camera(this);
  }

  /** `least`: width over height below which what was seen across is kept rather than what was seen upwards. */
  projection(width: number, height: number, least: number, box: Bounds): Projection {
    const a = viewAxes(sub(this.target, this.position), this.up);
    const lines = Math.min(height, width / least);
    const scale = this.parallel ? lines / this.height : (0.5 * lines) / Math.tan((this.angle * Math.PI) / 360);
    let lo = Infinity, hi = -Infinity;
    for (let i = 0; i < 8; ++i) {
      const z = dot(sub(cornerOf(box, i), this.position), a.forward);
      lo = Math.min(lo, z), hi = Math.max(hi, z);
    }
    const slack = 0.02 * Math.max(hi - lo, 1e-3 * Math.max(Math.abs(hi), Math.abs(lo)));
    const far = hi > 0 ? hi + slack : diagonalOf(box) || 1;
    const near = this.parallel ? lo - slack : Math.max(lo - slack, 1e-3 * far);
    return { ...a, width, height, parallel: this.parallel, eye: this.position, scale, near, far };
  }

  /** About the target: the picture follows the pointer, and no direction is locked. */
  turn(dx: number, dy: number): void {
    const a = viewAxes(sub(this.target, this.position), this.up);
    const axis = add(mul(a.up, -dx), mul(a.right, -dy)), angle = len(axis);
    if (!(angle > 0)) return;
    const about = unit(axis);
    this.position = add(this.target, turned(sub(this.position, this.target), about, angle));
    this.up = unit(turned(a.up, about, angle));
  }
  roll(angle: number): void {
    this.up = turned(this.up, unit(sub(this.position, this.target)), angle);
  }
  /** By shares of the picture's height. */
  pan(dx: number, dy: number): void {
    const a = viewAxes(sub(this.target, this.position), this.up);
    const high = this.parallel ? this.height : 2 * len(sub(this.target, this.position)) * Math.tan((this.angle * Math.PI) / 360);
    const move = add(mul(a.right, -dx * high), mul(a.up, dy * high));
    this.position = add(this.position, move), this.target = add(this.target, move);
  }
  zoom(factor: number): void {
    this.height /= factor;
    this.position = add(this.target, mul(sub(this.position, this.target), 1 / factor));
  }
  /** The same size at the target. */
  setParallel(parallel: boolean): void {
    if (parallel === this.parallel) return;
    const per = 2 * Math.tan((this.angle * Math.PI) / 360), towards = sub(this.position, this.target);
    if (parallel) this.height = len(towards) * per;
    else this.position = add(this.target, mul(unit(towards), this.height / per));
    this.parallel = parallel;
  }

  /** All of the box with `margin` of the picture free at each side, as fit_camera() does. */
  fit(box: Bounds, direction: Vec3, up: Vec3, aspect: number, margin: number): void {
    const center = centerOf(box), size = diagonalOf(box) || 1, a = viewAxes(mul(direction, -1), up), room = 1 - 2 * margin;
    const p = Array.from({ length: 8 }, (_, i) => sub(cornerOf(box, i), center)).map((d): Vec3 => [dot(d, a.right), dot(d, a.up), dot(d, a.forward)]);
    this.up = a.up;
    const halfX = Math.max(...p.map((q) => Math.abs(q[0]))), halfY = Math.max(...p.map((q) => Math.abs(q[1])));
    this.height = (2 * Math.max(halfY, halfX / aspect)) / room || size;
    if (this.parallel) {
      this.target = center;
      this.position = sub(center, mul(a.forward, 2 * size));
      return;
    }
    const ky = Math.tan((this.angle * Math.PI) / 360) * room, kx = ky * aspect;
    const right = Math.max(...p.map((q) => q[0] - kx * q[2])), left = Math.max(...p.map((q) => -q[0] - kx * q[2]));
    const top = Math.max(...p.map((q) => q[1] - ky * q[2])), bottom = Math.max(...p.map((q) => -q[1] - ky * q[2]));
    let distance = Math.max((right + left) / (2 * kx), (top + bottom) / (2 * ky));
    distance = Math.max(distance, 0.05 * size - Math.min(...p.map((q) => q[2])));
    this.target = add(center, add(mul(a.right, (right - left) / 2), mul(a.up, (top - bottom) / 2)));
    this.position = sub(this.target, mul(a.forward, distance));
  }
}

/** Pixel of a place, y down, and its depth. */
export function toPixel(p: Projection, world: Vec3): Vec3 {
  const d = sub(world, p.eye), z = dot(d, p.forward), s = p.parallel ? p.scale : p.scale / z;
  return [0.5 * p.width + s * dot(d, p.right), 0.5 * p.height - s * dot(d, p.up), z];
}
