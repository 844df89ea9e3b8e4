// SPDX-License-Identifier: Apache-2.0
// Colours as text: what the browser's swatch takes (#rrggbb), and what a parameter of three numbers takes.

const byte = (x: number): string => Math.round(Math.min(1, Math.max(0, x)) * 255).toString(16).padStart(2, "0");
const partsOf = (hex: string): number[] => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
const encode = (x: number): number => (x <= 0.0031308 ? 12.92 * x : 1.055 * Math.pow(x, 1 / 2.4) - 0.055);
const decode = (x: number): number => (x <= 0.04045 ? x / 12.92 : Math.pow((x + 0.055) / 1.055, 2.4));

/** Three numbers, or null. */
function three(text: string): number[] | null {
  const parts = text.split(",").map((s) => (s.trim() === "" ? NaN : Number(s)));
  return parts.length === 3 && parts.every(Number.isFinite) ? parts : null;
}

/** A colour of the screen as #rrggbb: written so, as three numbers, or by a name that the browser knows; else null. */
export function knownHex(text: string): string | null {
  if (/^#[0-9a-f]{6}$/i.test(text)) return text.toLowerCase();
  const rgb = three(text);
  if (rgb) return `#${rgb.map(byte).join("")}`;
  if (typeof document === "undefined" || !text) return null;
  const context = document.createElement("canvas").getContext("2d");
  if (!context) return null;
  // What it does not know leaves the colour before it standing.
  const found = ["#000000", "#ffffff"].map((before) => {
    context.fillStyle = before;
    context.fillStyle = text;
    return String(context.fillStyle);
  });
  return found[0] === found[1] && found[0].startsWith("#") ? found[0] : null;
}

/** The same; of what is no colour, grey. */
export const hexOf = (text: string): string => knownHex(text) ?? "#808080";

/** The swatch of three numbers. Light that is brighter than white is shown as bright as white. */
export function hexOfNumbers(text: string, linear: boolean): string {
  const rgb = three(text);
  if (!rgb) return "#808080";
  const top = Math.max(1, ...rgb);
  return `#${rgb.map((x) => byte(linear ? encode(Math.max(0, x) / top) : x)).join("")}`;
}

/** Three numbers of a swatch; light that was brighter than white before stays as bright. */
export function numbersOfHex(hex: string, linear: boolean, before: string): string {
  const top = linear ? Math.max(1, ...(three(before) ?? [])) : 1;
  return partsOf(hex).map((x) => String(Number((linear ? top * decode(x) : x).toPrecision(3)))).join(",");
}
