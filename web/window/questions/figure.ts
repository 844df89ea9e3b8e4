// SPDX-License-Identifier: Apache-2.0
// A curve as a figure for papers: a self-contained SVG, black on white.
import type { Curve } from "./curve";
import { roundValues } from "../transfer/opacity";
import { plain } from "../words";

const size = { w: 720, h: 440, left: 76, right: 20, top: 20, bottom: 56 };

const escaped = (s: string): string => s.replace(/[&<>]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[c]!);

export function figure(a: Curve, xLabel: string, yLabel: string): string {
  const values = a.values.filter((v): v is number => v !== null && Number.isFinite(v));
  const xs: [number, number] = [a.x[0] ?? 0, a.x[a.x.length - 1] ?? 1];
  let ys: [number, number] = values.length > 0 ? [Math.min(...values), Math.max(...values)] : [0, 1];
  if (!(ys[1] > ys[0])) ys = [ys[0] - 0.5, ys[0] + 0.5];
  const x = (v: number): number => size.left + ((v - xs[0]) / (xs[1] - xs[0] || 1)) * (size.w - size.left - size.right);
  const y = (v: number): number => size.h - size.bottom - ((v - ys[0]) / (ys[1] - ys[0])) * (size.h - size.top - size.bottom);
  // A gap of the values is a gap of the line.
  let path = "";
  let pen = false;
  a.values.forEach((v, i) => {
    if (v === null || !Number.isFinite(v)) pen = false;
    else {
      path += `${pen ? "L" : "M"}${x(a.x[i]).toFixed(2)} ${y(v).toFixed(2)}`;
      pen = true;
    }
  });
  const base = size.h - size.bottom;
  const xTicks = roundValues(xs, 6).map((t) => `<path d="M${x(t)} ${base}v5"/><text x="${x(t)}" y="${base + 20}" text-anchor="middle">${plain(t)}</text>`);
  const yTicks = roundValues(ys, 5).map((t) => `<path d="M${size.left} ${y(t)}h-5"/><text x="${size.left - 9}" y="${y(t) + 4}" text-anchor="end">${plain(t)}</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${size.w}" height="${size.h}" viewBox="0 0 ${size.w} ${size.h}" font-family="sans-serif" font-size="13">
<rect width="100%" height="100%" fill="white"/>
<g stroke="black" fill="none"><path d="M${size.left} ${size.top}V${base}H${size.w - size.right}"/></g>
<g stroke="black" stroke-width="1"><g fill="black" stroke-width="0">${[...xTicks, ...yTicks].map((t) => t.replace("<path ", '<path stroke="black" stroke-width="1" fill="none" ')).join("\n")}</g></g>
<path d="${path}" fill="none" stroke="#0b62a4" stroke-width="1.75" stroke-linejoin="round"/>
<text x="${(size.left + size.w - size.right) / 2}" y="${size.h - 12}" text-anchor="middle">${escaped(xLabel)}</text>
<text transform="translate(18 ${(size.top + base) / 2}) rotate(-90)" text-anchor="middle">${escaped(yLabel)}</text>
</svg>
`;
}
