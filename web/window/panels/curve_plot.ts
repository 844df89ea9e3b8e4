// SPDX-License-Identifier: Apache-2.0
// Curves over a line and over time, drawn by uPlot.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Curve } from "../questions/curve";
import { plain } from "../words";

interface Drawn {
  plot: uPlot;
  values: Curve["values"];
  dark: boolean;
}
const plots = new Map<string, Drawn>();

/** `name`: one plot of each is drawn at a time; without a holder it is taken away. */
export function drawCurve(name: string, holder: HTMLElement | undefined, curve: Curve, label: string, xLabel: string): void {
  const before = plots.get(name);
  if (!holder) {
    before?.plot.destroy();
    plots.delete(name);
    return;
  }
  const css = getComputedStyle(document.documentElement);
  const isDark = document.documentElement.dataset.theme === "dark";
  if (before && before.values === curve.values && before.dark === isDark && before.plot.root.parentElement === holder) return;
  before?.plot.destroy();
  const color = (name: string): string => css.getPropertyValue(name).trim();
  const axis = { stroke: color("--quiet"), grid: { stroke: color("--line"), width: 1 }, ticks: { stroke: color("--line"), width: 1 }, font: "12px system-ui", labelFont: "12px system-ui", labelSize: 22, values: (_: uPlot, ticks: number[]) => ticks.map((t) => plain(t)) };
  const plot = new uPlot(
    {
      width: Math.max(240, holder.clientWidth || 340),
      height: 230,
      scales: { x: { time: false } },
      legend: { live: true },
      series: [
        { label: xLabel, value: (_, v) => plain(v) },
        { label, stroke: color("--accent"), width: 1.5, spanGaps: false, value: (_, v) => plain(v) },
      ],
      axes: [{ ...axis, label: xLabel }, { ...axis, label, size: 56 }],
    },
    [curve.x, curve.values],
    holder,
  );
  plots.set(name, { plot, values: curve.values, dark: isDark });
}
