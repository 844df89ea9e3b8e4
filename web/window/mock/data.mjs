// SPDX-License-Identifier: Apache-2.0
// What the stand-in server knows of a file: from `sightglass info --json`, and colour maps from `sightglass colormap --json`.
import { execFileSync } from "node:child_process";

export function describe(program, file) {
  const ask = (...args) => JSON.parse(execFileSync(program, args, { maxBuffer: 1 << 26, stdio: ["ignore", "pipe", "ignore"] }));
  const info = ask("info", "--json", file);
  const fields = (info.fields ?? []).filter((f) => f.association !== "whole").map((f) => ({
    name: f.name,
    on: f.association,
    components: f.components ?? 1,
    unit: f.unit ?? "",
    range: f.range?.[0] ?? [0, 1],
  }));
  const bounds = (info.bounds ?? [0, 1, 0, 1, 0, 1]).flat();
  const kind = info.kind ?? info.mesh ?? "uniform";
  const volume = /uniform/.test(kind);
  const maps = new Map();
  return {
    kind,
    size: info.dims.join("x") || `${info.points} points, ${info.cells} cells`,
    fields: fields.length ? fields : [{ name: "value", on: "point", components: 1, unit: "", range: [0, 1] }],
    bounds,
    show: volume ? "volume" : "surface",
    words: {},
    times: info.times.length > 1 ? info.times : (process.env.MOCK_TIMES ? Array.from({ length: 12 }, (_, i) => i * 0.5) : []),
    camera: firstCamera(bounds),
    notes: [`shown as ${volume ? "a volume" : "its outer surface"}, coloured by '${fields[0]?.name ?? "value"}'`],
    map(name) {
      if (!maps.has(name)) {
        try {
          const m = ask("colormap", name, "--json");
          // The program prints no colours; greys of the same lightness stand for them.
          const grey = (l) => `#${Math.round((l / 100) * 255).toString(16).padStart(2, "0").repeat(3)}`;
          maps.set(name, { colors: m.lightness.map(grey), lightness: m.lightness.filter((_, i) => i % 4 === 0).map((l) => l / 100) });
        } catch {
          maps.set(name, { colors: ["#000000", "#ffffff"], lightness: [0, 1] });
        }
      }
      return maps.get(name);
    },
    opacity(text, a, b) {
      if (!text) return [[a, 0], [a + 0.3 * (b - a), 0], [a + 0.45 * (b - a), 0.25], [b, 0.8]];
      return text.split(",").map((p) => {
        const [x, y] = p.split(":");
        return [x.startsWith("@") ? Number(x.slice(1)) : a + Number(x) * (b - a), Number(y)];
      });
    },
  };
}

function firstCamera(b) {
  const target = [(b[0] + b[1]) / 2, (b[2] + b[3]) / 2, (b[4] + b[5]) / 2];
  const size = Math.hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]) || 1;
  const d = [0.45, -0.75, 0.48].map((x) => x * size * 2.1);
  return {
    position: target.map((t, i) => t + d[i]),
    target,
    up: [0, 0, 1],
    parallel: false,
    view_angle: 30,
    height: 2 * Math.hypot(...d) * Math.tan(Math.PI / 12),
  };
}
