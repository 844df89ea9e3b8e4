// SPDX-License-Identifier: Apache-2.0
// How far the sliders of a shift go: as far as the data were large when they were first seen. What is moved takes the bounds of the picture
// with it, and a slider must not change under the hand.
import type { Context } from "./form";

const known = new Map<string, number>();

/** Null for all that is no shift, and where nothing is seen. */
export function shiftReach(c: Context): number | null {
  const b = c.app.state?.bounds;
  if (c.name !== "translate" || !b) return null;
  const size = known.get(c.at) ?? Number(Math.hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]).toPrecision(2));
  if (!(size > 0)) return null;
  known.set(c.at, size);
  // A value beyond that was typed.
  const far = Math.max(0, ...(c.value ?? "").split(",").map((s) => Math.abs(Number(s) || 0)));
  return Math.max(size, far);
}
