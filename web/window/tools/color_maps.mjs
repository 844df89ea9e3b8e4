// SPDX-License-Identifier: Apache-2.0
// node window/tools/color_maps.mjs SIGHTGLASS > window/transfer/map_table.ts
// Names, kinds and 17 colours of each colour map that the program knows, for the list of maps. The colours that a picture uses come from
// the server, not from here.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { inflateSync } from "node:zlib";

const program = process.argv[2] ?? "sightglass";
const folder = mkdtempSync(join(tmpdir(), "color-maps-"));
const { colormaps } = JSON.parse(execFileSync(program, ["colormap", "--json"]));

/** The first row of a PNG of 8 bits per channel. */
function firstRow(file) {
  const bytes = readFileSync(file);
  let width = 0;
  let channels = 3;
  const data = [];
  for (let p = 8; p < bytes.length; ) {
    const length = bytes.readUInt32BE(p);
    const type = bytes.toString("latin1", p + 4, p + 8);
    if (type === "IHDR") {
      width = bytes.readUInt32BE(p + 8);
      channels = bytes[p + 17] === 6 ? 4 : 3;
    }
    if (type === "IDAT") data.push(bytes.subarray(p + 8, p + 8 + length));
    p += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(data));
  const row = [...raw.subarray(1, 1 + width * channels)];
  // In the first row the filters "up" and "none" are the same, "sub", "average" and "Paeth" add what is to the left.
  const filter = raw[0];
  for (let i = channels; i < row.length; i++) {
    if (filter === 1 || filter === 4) row[i] = (row[i] + row[i - channels]) & 255;
    if (filter === 3) row[i] = (row[i] + (row[i - channels] >> 1)) & 255;
  }
  return { width, at: (x) => row.slice(x * channels, x * channels + 3) };
}

const hex = (rgb) => rgb.map((c) => c.toString(16).padStart(2, "0")).join("");
const samples = 17;
const lines = colormaps.map((m) => {
  const file = join(folder, "map.png");
  execFileSync(program, ["colormap", m.name, "-o", file], { stdio: "ignore" });
  const row = firstRow(file);
  const colors = Array.from({ length: samples }, (_, i) => hex(row.at(Math.round((i / (samples - 1)) * (row.width - 1)))));
  return `  [${JSON.stringify(m.name)}, ${JSON.stringify(m.kind)}, ${JSON.stringify(m.about)}, ${JSON.stringify(colors.join(""))}],`;
});
rmSync(folder, { recursive: true });
process.stdout.write(`// SPDX-License-Identifier: Apache-2.0
// Written by tools/color_maps.mjs: name, kind, sentence, and 17 colours of each map.
export const mapTable: [string, string, string, string][] = [
${lines.join("\n")}
];
`);
