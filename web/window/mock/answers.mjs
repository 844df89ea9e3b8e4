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
    case "measures": {
      const part = m.among?.lasso || m.among?.box || m.among?.value ? 0.25 : 1;
      const steps = [];
      if (m.among?.box) steps.push({ operation: "extract", set: { box: m.among.box.join(","), by_center: "true" } });
      if (m.among?.lasso) steps.push({ operation: "extract", set: { lasso: "0,0,0,1,0,0,0,1,0", by_center: "true" } });
      if (m.among?.value) steps.push({ operation: "threshold", set: { field: m.among.value.field, min: String(m.among.value.range[0]), max: String(m.among.value.range[1]), mean: "true" } });
      return {
        is: "measures",
        points: Math.round(110592 * part),
        cells: Math.round(103823 * part),
        measure: 8000 * part,
        dimension: 3,
        length_unit: "mm",
        fields: info.fields.map((f) => ({ name: f.name, on: "point", component: -1, unit: f.unit ?? "", count: Math.round(110592 * part), missing: 0, min: f.range[0], max: f.range[1], mean: (f.range[0] + f.range[1]) / 2, deviation: (f.range[1] - f.range[0]) / 6, median: (f.range[0] + f.range[1]) / 2, integral: 8000 * part * ((f.range[0] + f.range[1]) / 2) })),
        steps,
      };
    }
    case "over_time":
      return { is: "over_time", unit: field.unit, times: info.times, values: info.times.map((t, i) => a + (b - a) * (0.5 + 0.4 * Math.sin(i))) };
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
      if (m.at) return { is: "plane", at: [a + 0.3 * (b - a), (b - a) / 10] };
      const [w, h] = [64, 48];
      const counts = [];
      for (let j = 0; j < h; j++) for (let i = 0; i < w; i++) counts.push(Math.round(4000 * Math.exp(-((i - 10) ** 2 + j * j * 4) / 60) + 800 * Math.exp(-((((i - 30) / 16) ** 2 + (j - 30) / 20) ** 2) * 9)));
      return { is: "plane", value: [a, b], second: [0, (b - a) / 4], size: [w, h], counts };
    }
    default:
      return null;
  }
}
