// SPDX-License-Identifier: Apache-2.0
// What can be done with a camera besides turning it: pure functions from camera to camera.
import type { Camera, State, Vec3 } from "../protocol";
import { add, anyNormal, cross, dot, length, scale, sub, unit } from "./vector";

export interface Frame {
  right: Vec3;
  up: Vec3;
  back: Vec3; // from the target towards the viewer
}

/** The camera's axes, orthonormal even where up is parallel to the line of sight. */
export function frameOf(camera: Camera): Frame {
  const back = unit(sub(camera.position, camera.target));
  const right = unit(cross(camera.up, back), anyNormal(back));
  return { right, up: cross(back, right), back };
}

export const distanceOf = (camera: Camera): number => Math.max(length(sub(camera.position, camera.target)), 1e-12);

const tangent = (camera: Camera): number => Math.tan((camera.view_angle * Math.PI) / 360);

/** World length of the picture's height in the plane of the target. */
export const heightAtTarget = (camera: Camera): number =>
  camera.parallel ? camera.height : 2 * distanceOf(camera) * tangent(camera);

/** Moves the picture by a share of its height: dx to the right, dy upwards. */
export function pan(camera: Camera, dx: number, dy: number): Camera {
  const { right, up } = frameOf(camera);
  const h = heightAtTarget(camera);
  const by = add(scale(right, -dx * h), scale(up, -dy * h));
  return { ...camera, position: add(camera.position, by), target: add(camera.target, by) };
}

/**
 * Magnifies by a factor, keeping the point at (x, y) of the plane of the target where it is; x and y count in heights of the picture
 * from its middle, upwards.
 */
export function zoom(camera: Camera, factor: number, x = 0, y = 0): Camera {
  const f = Math.min(Math.max(factor, 1e-3), 1e3);
  const before = heightAtTarget(camera);
  const back = sub(camera.position, camera.target);
  const { right, up } = frameOf(camera);
  const h = before / f;
  const shift = add(scale(right, x * (before - h)), scale(up, y * (before - h)));
  const target = add(camera.target, shift);
  if (camera.parallel) return { ...camera, target, position: add(target, back), height: camera.height / f };
  return { ...camera, target, position: add(target, scale(back, 1 / f)), height: camera.height / f };
}

/** Changes between perspective and parallel, the plane of the target keeping its size. */
export function toggleProjection(camera: Camera): Camera {
  const height = heightAtTarget(camera);
  if (!camera.parallel) return { ...camera, parallel: true, height };
  const { back } = frameOf(camera);
  return { ...camera, parallel: false, height, position: add(camera.target, scale(back, height / 2 / tangent(camera))) };
}

export type Bounds = NonNullable<State["bounds"]>;

/** Looks at the box from a direction so that all of it is seen, with a margin on each side. */
export function fit(camera: Camera, box: Bounds, direction: Vec3, up: Vec3, aspect: number, margin = 0.08): Camera {
  const target: Vec3 = [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, (box[4] + box[5]) / 2];
  const axes = frameOf({ ...camera, position: add(target, direction), target, up });
  const inner = 1 - 2 * margin;
  const t = tangent(camera) * inner;
  let height = 0;
  let distance = 0;
  for (let corner = 0; corner < 8; corner++) {
    const p: Vec3 = [box[corner & 1], box[2 + ((corner >> 1) & 1)], box[4 + (corner >> 2)]];
    const d = sub(p, target);
    const x = Math.abs(dot(d, axes.right)) / aspect;
    const y = Math.abs(dot(d, axes.up));
    height = Math.max(height, (2 * Math.max(x, y)) / inner);
    distance = Math.max(distance, Math.max(x, y) / t + dot(d, axes.back));
  }
  const size = length(sub([box[1], box[3], box[5]], [box[0], box[2], box[4]])) || 1;
  height = height || size;
  distance = Math.max(distance, size * 1e-3);
  if (camera.parallel) distance = Math.max(distance, size);
  return { ...camera, target, up: axes.up, position: add(target, scale(axes.back, distance)), height };
}

export interface NamedView {
  key: string;
  name: string;
  direction: Vec3;
  up: Vec3;
}

/** The named views, for data whose z or y axis points up. */
export function namedViews(upIsY: boolean): NamedView[] {
  const turn = (v: Vec3): Vec3 => (upIsY ? [v[0], v[2], -v[1]] : v);
  const view = (key: string, name: string, direction: Vec3, up: Vec3 = [0, 0, 1]): NamedView => ({
    key,
    name,
    direction: turn(direction),
    up: turn(up),
  });
  return [
    view("1", "front", [0, -1, 0]),
    view("2", "back", [0, 1, 0]),
    view("3", "left", [-1, 0, 0]),
    view("4", "right", [1, 0, 0]),
    view("5", "top", [0, 0, 1], [0, 1, 0]),
    view("6", "bottom", [0, 0, -1], [0, -1, 0]),
    view("7", "iso", [1, -1, 0.8]),
  ];
}

/** Whether the camera chosen for the data holds y upwards, as for graphics. */
export const upIsY = (camera: Camera | null): boolean =>
  camera !== null && Math.abs(camera.up[1]) > Math.abs(camera.up[2]) && Math.abs(camera.up[1]) > Math.abs(camera.up[0]) &&
  Math.abs(unit(sub(camera.position, camera.target))[2]) < 0.9;
