// SPDX-License-Identifier: Apache-2.0
// Views side by side whose cameras go together.
import { distanceOf, frameOf } from "../camera/camera";
import { add, dot, scale, sub } from "../camera/vector";
import type { Camera, Vec3 } from "../protocol";

export type Link = "none" | "place" | "all";

/** The camera of another view after one has gone from `before` to `after`: the place and magnification, or the turning as well. */
export function follow(other: Camera, before: Camera, after: Camera, link: Link): Camera {
  if (link === "none") return other;
  const target = add(other.target, sub(after.target, before.target));
  let back = scale(sub(other.position, other.target), distanceOf(after) / distanceOf(before));
  let up = other.up;
  if (link === "all") {
    const a = frameOf(before);
    const b = frameOf(after);
    // The rotation that takes the one frame to the other, applied to any vector.
    const turned = (v: Vec3): Vec3 =>
      add(add(scale(b.right, dot(v, a.right)), scale(b.up, dot(v, a.up))), scale(b.back, dot(v, a.back)));
    back = turned(back);
    up = turned(up);
  }
  return { ...other, target, position: add(target, back), up, height: other.height * (after.height / before.height || 1) };
}
