// SPDX-License-Identifier: Apache-2.0
export const decodeSrgb = (v: number) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
export const encodeSrgb = (v: number) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
export const cssColor = (c: ArrayLike<number>) => `rgb(${c[0]} ${c[1]} ${c[2]})`;
/** sRGB from 0 to 1. */
export const cssOf = (c: ArrayLike<number>) => cssColor([0, 1, 2].map((k) => Math.round(255 * c[k])));
