// SPDX-License-Identifier: Apache-2.0
// How large a picture may be that the server saves.

/** The size, smaller in the same shape where it has more pixels than may be. */
export function fitted(width: number, height: number, most: number): [number, number] {
  const by = Math.min(1, Math.sqrt(most / (width * height)));
  return [Math.max(1, Math.floor(width * by)), Math.max(1, Math.floor(height * by))];
}

/** What is wrong with a size; "" for nothing. */
export function sizeProblem(width: number, height: number, most: number): string {
  if (width * height <= most) return "";
  const [w, h] = fitted(width, height, most);
  return `${width} × ${height} are more than the ${(most / 1e6).toFixed(1)} million pixels that a picture may have; ${w} × ${h} are not.`;
}
