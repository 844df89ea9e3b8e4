// SPDX-License-Identifier: Apache-2.0
// Invented answers to questions about the data.

export function answer(m, pipeline) {
  const { info } = pipeline;
  const field = info.fields[0];
  const [a, b] = field.range;
  switch (m.do) {
    case "probe": {
      const [x, y] = m.at;
      const c = info.camera.target;
      const seen = x > 100 && y > 60;
      return {
        is: "probe",
        position: seen ? [c[0] + x / 100, c[1] + y / 100, c[2]] : null,
        show: 0,
        values: seen ? info.fields.slice(0, 4).map((f) => ({ name: f.name, value: String(Number((f.range[0] + ((x % 500) / 500) * (f.range[1] - f.range[0])).toPrecision(5))), unit: f.unit })) : [],
        cell: seen ? Math.round(x * y) : null,
      };
    }
    case "rows": {
      const total = 6000;
      const n = Math.max(0, Math.min(m.count, total - m.from));
      return {
        is: "rows",
        total,
        columns: ["x", "y", "z", ...info.fields.slice(0, 5).map((f) => f.name)],
        rows: Array.from({ length: n }, (_, i) => [m.from + i, i * 2, 0, ...info.fields.slice(0, 5).map((_, k) => ((m.from + i) * (k + 1) * 0.137).toFixed(4))].map(String)),
      };
    }
    case "line": {
      const n = m.count;
      const distance = Array.from({ length: n }, (_, i) => (i / (n - 1)) * Math.hypot(...m.to.map((t, k) => t - m.from[k])));
      return { is: "line", unit: field.unit, distance, values: distance.map((_, i) => (i < n / 12 ? null : a + (b - a) * (0.5 + 0.4 * Math.sin(i / 14) * Math.exp(-i / 150)))) };
    }
    case "proposals":
      return {
        is: "proposals",
        list: [
          { words: { opacity: `@${a}:0,@${a + 0.4 * (b - a)}:0,@${a + 0.5 * (b - a)}:0.6,@${b}:0.9` }, reason: "the strongest boundary of materials lies at 45 % of the range" },
          { words: { opacity: `@${a}:0,@${b}:0.6`, map: "ember" }, reason: "all values, the higher the denser" },
        ],
      };
    case "histogram":
      return { is: "histogram", range: [a, b], counts: Array.from({ length: 64 }, (_, i) => Math.round(1000 * Math.exp(-((i - 20) ** 2) / 60))) };
    case "plane": {
      const [w, h] = [64, 48];
      const counts = [];
      for (let j = 0; j < h; j++) for (let i = 0; i < w; i++) counts.push(Math.round(4000 * Math.exp(-((i - 10) ** 2 + j * j * 4) / 60) + 800 * Math.exp(-((((i - 30) / 16) ** 2 + (j - 30) / 20) ** 2) * 9)));
      return { is: "plane", value: [a, b], second: [0, (b - a) / 4], size: [w, h], counts };
    }
    default:
      return null;
  }
}
