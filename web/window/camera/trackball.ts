// SPDX-License-Identifier: Apache-2.0
// Turning with a virtual trackball: a sphere in the middle that passes into a hyperbola outside of it (Bell 1988, after Shoemake 1992).
// There is no fixed "up", so that no direction locks.
import type { Camera, Vec3 } from "../protocol";
import { frameOf } from "./camera";
import { add, cross, dot, length, rotate, scale, sub, unit } from "./vector";

const radius = 0.8;

/** The point of the trackball under (x, y), counted in half heights of the picture from its middle, y upwards. */
export function onBall(x: number, y: number): Vec3 {
  const d2 = x * x + y * y;
  const r2 = radius * radius;
  return [x, y, d2 <= r2 / 2 ? Math.sqrt(r2 - d2) : r2 / (2 * Math.sqrt(d2))];
}

/** The camera with its axes at right angles again; rounding would bend them over thousands of small turns. */
function straightened(camera: Camera, back: Vec3, up: Vec3, distance: number): Camera {
  const b = unit(back);
  const u = unit(sub(up, scale(b, dot(up, b))));
  return { ...camera, up: u, position: add(camera.target, scale(b, distance)) };
}

/** Turns the scene about an axis given in the camera's frame (right, up, towards the viewer). */
export function turn(camera: Camera, axis: Vec3, angle: number): Camera {
  const f = frameOf(camera);
  const world = unit(add(add(scale(f.right, axis[0]), scale(f.up, axis[1])), scale(f.back, axis[2])), f.up);
  const back = sub(camera.position, camera.target);
  // To turn the scene by an angle, the camera goes round by the opposite one.
  return straightened(camera, rotate(back, world, -angle), rotate(f.up, world, -angle), length(back));
}

/** Turns the scene as a ball dragged from one place to another. */
export function drag(camera: Camera, from: [number, number], to: [number, number]): Camera {
  const a = onBall(...from);
  const b = onBall(...to);
  const axis = cross(a, b);
  if (length(axis) < 1e-12) return camera;
  const chord = length(sub(b, a)) / (2 * radius);
  return turn(camera, unit(axis), 2 * Math.asin(Math.min(1, chord)));
}

/** Rolls the picture counter-clockwise about the line of sight. */
export const roll = (camera: Camera, angle: number): Camera => turn(camera, [0, 0, 1], angle);
