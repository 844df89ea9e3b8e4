// SPDX-License-Identifier: Apache-2.0
// The picture's layout in a window of any size: letters and legends grow with it as those of a picture of that size would.
import type { AnnotationInfo } from "../data/format";

export interface Rect {
  x: number;
  y: number;
  width: number;
  height: number;
}
export const overlaps = (a: Rect, b: Rect) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
export const grown = (r: Rect, by: number): Rect => ({ x: r.x - by, y: r.y - by, width: r.width + 2 * by, height: r.height + 2 * by });

const lines = (width: number, height: number) => Math.max(432, Math.min(height, 0.8 * width));  // letters of 9 pixels are the smallest

export interface Layout {
  width: number;
  height: number;
  /** Lengths of the stated picture to those of the window. */
  factor: number;
  /** The picture beside its legends. */
  area: Rect;
}

export function layoutOf(a: AnnotationInfo, width: number, height: number): Layout {
  const factor = lines(width, height) / lines(a.width, a.height), [x, y, w, h] = a.area;
  const left = Math.round(x * factor), top = Math.round(y * factor);
  const right = Math.round((a.width - x - w) * factor), bottom = Math.round((a.height - y - h) * factor);
  const narrow = (left + right) * 2 > width, low = (top + bottom) * 2 > height;
  const area = {
    x: narrow ? 0 : left, y: low ? 0 : top,
    width: Math.max(1, narrow ? width : width - left - right), height: Math.max(1, low ? height : height - top - bottom),
  };
  return { width, height, factor, area };
}
