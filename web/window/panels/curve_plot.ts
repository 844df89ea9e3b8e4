// SPDX-License-Identifier: Apache-2.0
// The curve of values along a line, drawn by uPlot.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { LineAnswer } from "../protocol";
import { plain } from "../words";

let plot: uPlot | null = null;
let drawn: LineAnswer | null = null;
let dark = false;

export function drawCurve(holder: HTMLElement | undefined, answer: LineAnswer, label: string, distance: string): void {
  if (!holder) {
    plot?.destroy();
    plot = null;
    drawn = null;
    return;
  }
  const css = getComputedStyle(document.documentElement);
  const isDark = document.documentElement.dataset.theme === "dark";
  if (plot && drawn === answer && dark === isDark && plot.root.parentElement === holder) return;
  plot?.destroy();
  drawn = answer;
  dark = isDark;
  const color = (name: string): string => css.getPropertyValue(name).trim();
  const axis = { stroke: color("--quiet"), grid: { stroke: color("--line"), width: 1 }, ticks: { stroke: color("--line"), width: 1 }, font: "12px system-ui", labelFont: "12px system-ui", labelSize: 22, values: (_: uPlot, ticks: number[]) => ticks.map((t) => plain(t)) };
  plot = new uPlot(
    {
      width: Math.max(240, holder.clientWidth || 340),
      height: 230,
      scales: { x: { time: false } },
      legend: { live: true },
      series: [
        { label: "distance", value: (_, v) => plain(v) },
        { label, stroke: color("--accent"), width: 1.5, spanGaps: false, value: (_, v) => plain(v) },
      ],
      axes: [{ ...axis, label: distance }, { ...axis, label, size: 56 }],
    },
    [answer.distance, answer.values],
    holder,
  );
}
