// SPDX-License-Identifier: Apache-2.0
// From the world to CSS pixels of a view and back, as the renderer does it.
import type { Camera, State, Vec3 } from "../protocol";
import { frameOf, heightAtTarget } from "./camera";
import { add, dot, scale, sub } from "./vector";

export interface Size {
  width: number;
  height: number;
}

/** Place of a point in the view, null behind the viewer. */
export function toPixel(camera: Camera, size: Size, point: Vec3): [number, number] | null {
  const f = frameOf(camera);
  const d = sub(point, camera.position);
  const depth = -dot(d, f.back);
  const perPixel = pixelSize(camera, size, depth);
  if (!(perPixel > 0)) return null;
  return [size.width / 2 + dot(d, f.right) / perPixel, size.height / 2 - dot(d, f.up) / perPixel];
}

/** The same of a place of the data, which the picture may show stretched. */
export function placeInView(state: State | null, camera: Camera, size: Size, place: Vec3): [number, number] | null {
  const s = state?.stretch ?? [1, 1, 1];
  return toPixel(camera, size, [place[0] * s[0], place[1] * s[1], place[2] * s[2]]);
}

const stretchOf = (state: State | null): Vec3 => state?.stretch ?? [1, 1, 1];

/** The bounds of the data, which those of a state are but for the stretch. */
export function dataBounds(state: State): NonNullable<State["bounds"]> | null {
  const s = stretchOf(state);
  if (!state.bounds) return null;
  const b = state.bounds.map((x, i) => x / s[i >> 1]);
  for (const i of [0, 2, 4]) if (b[i] > b[i + 1]) [b[i], b[i + 1]] = [b[i + 1], b[i]]; // a negative stretch turns them round
  return b as NonNullable<State["bounds"]>;
}

/** How far a place of the data goes in the data when it is dragged by pixels within the plane of the picture. */
export function placeDragged(state: State | null, camera: Camera, size: Size, place: Vec3, dx: number, dy: number): Vec3 {
  const s = stretchOf(state);
  const by = dragged(camera, size, place.map((x, i) => x * s[i]) as Vec3, dx, dy);
  return by.map((x, i) => x / s[i]) as Vec3;
}

/** How many times a direction of the data a drag of pixels leads along it. */
export function placeDraggedAlong(state: State | null, camera: Camera, size: Size, place: Vec3, direction: Vec3, dx: number, dy: number): number {
  const s = stretchOf(state);
  const shown = direction.map((x, i) => x * s[i]) as Vec3;
  const length = Math.hypot(...shown);
  const unit = scale(shown, 1 / length);
  return draggedAlong(camera, size, place.map((x, i) => x * s[i]) as Vec3, unit, dx, dy) / length;
}

/** World length of a CSS pixel at a depth. */
export function pixelSize(camera: Camera, size: Size, depth: number): number {
  if (camera.parallel) return camera.height / size.height;
  return (2 * depth * Math.tan((camera.view_angle * Math.PI) / 360)) / size.height;
}

/** How far a point at `origin` goes in the world when it is dragged by pixels, within the plane of the picture. */
export function dragged(camera: Camera, size: Size, origin: Vec3, dx: number, dy: number): Vec3 {
  const f = frameOf(camera);
  const depth = -dot(sub(origin, camera.position), f.back);
  const perPixel = camera.parallel || depth > 0 ? pixelSize(camera, size, depth) : heightAtTarget(camera) / size.height;
  return add(scale(f.right, dx * perPixel), scale(f.up, -dy * perPixel));
}

/** How far along a direction of length 1 a drag of pixels leads; the direction seen head on counts upward pixels instead. */
export function draggedAlong(camera: Camera, size: Size, origin: Vec3, direction: Vec3, dx: number, dy: number): number {
  const f = frameOf(camera);
  const from = sub(origin, camera.position);
  const depth = -dot(from, f.back);
  const perPixel = Math.abs(pixelSize(camera, size, depth)) || heightAtTarget(camera) / size.height;
  // In perspective what goes away also goes towards the middle of the picture, the more slowly the farther it is.
  const away = camera.parallel ? 0 : -dot(direction, f.back) / depth;
  const x = dot(direction, f.right) - away * dot(from, f.right);
  const y = dot(direction, f.up) - away * dot(from, f.up);
  const seen = Math.hypot(x, y);
  if (seen < 0.2) return -dy * perPixel * Math.sign(dot(direction, f.back) || 1);
  const along = ((dx * x - dy * y) / seen) * perPixel;
  const pace = seen - along * away;
  return pace > 1e-6 ? along / pace : Math.sign(along) * 1e6 * Math.abs(depth); // else beyond the end of the direction in the picture
}
