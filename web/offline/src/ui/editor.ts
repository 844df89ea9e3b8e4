// SPDX-License-Identifier: Apache-2.0
// The opacity of a volume over its values: points to be dragged over the histogram. A click adds one, a double click takes one away.
import { cssColor, encodeSrgb } from "../data/srgb";
import type { Viewer } from "../viewer";
import type { Curve } from "../volume/transfer";
import { button, element } from "./dom";

const width = 360, height = 150, reach = 9;

/** Words for the command line that make the same opacity. */
export function opacityWords(points: Curve): string {
  const text = (x: number) => String(Number(x.toPrecision(5)));
  return `volume opacity=${points.map(([v, o]) => `@${text(v)}:${text(o)}`).join(",")}`;
}

export class Editor {
  readonly panel: HTMLElement;
  readonly canvas = element("canvas", { tabIndex: 0, ariaLabel: "Opacity over values" });
  private readonly words = element("input", { readOnly: true, className: "words", ariaLabel: "The same on the command line" });
  private logarithmic = true;
  private held = -1;
  points: Curve;
  private most: number;

  constructor(private readonly v: Viewer) {
    const info = v.step.volumes[0].info;
    this.points = info.opacity.map(([x, o]) => [x, o] as [number, number]);
    this.most = Math.max(0.02, ...this.points.map(([, o]) => o));
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.canvas.width = width * ratio, this.canvas.height = height * ratio;
    this.canvas.style.width = `${width}px`, this.canvas.style.height = `${height}px`;
    this.canvas.getContext("2d")!.scale(ratio, ratio);
    const log = element("input", { type: "checkbox", checked: true });
    log.onchange = () => { this.logarithmic = log.checked, this.paint(); };
    const top = element("select", { ariaLabel: "Largest opacity shown", title: "Largest opacity shown" }, ...["0.02", "0.05", "0.1", "0.2", "0.5", "1"].map((o) => element("option", { value: o, textContent: `to ${o}` })));
    this.most = [0.02, 0.05, 0.1, 0.2, 0.5, 1].find((o) => o >= this.most * 0.999) ?? 1;
    top.value = String(this.most);
    top.onchange = () => { this.most = Number(top.value), this.paint(); };
    const back = button("reset", "The opacity of the picture", () => { this.points = info.opacity.map(([x, o]) => [x, o] as [number, number]), this.changed(); });
    const copy = button("copy", "Copy the words for the command line", () => { this.words.select(), document.execCommand("copy"); });
    this.panel = element("div", { className: "editor", hidden: true }, this.canvas, element("div", { className: "row" }, element("label", {}, log, " log counts"), top, back),
      element("div", { className: "row" }, this.words, copy));
    this.canvas.onpointerdown = (e) => this.press(e);
    this.canvas.onpointermove = (e) => this.drag(e);
    this.canvas.onpointerup = this.canvas.onpointercancel = () => { this.held = -1; };
    this.canvas.ondblclick = (e) => {
      const n = this.nearest(e);
      if (n >= 0 && this.points.length > 1) this.points.splice(n, 1), this.changed();
    };
    this.paint();
  }

  private x(value: number): number {
    const [lo, hi] = this.v.step.volumes[0].info.told;
    return ((value - lo) / (hi - lo || 1)) * (width - 1);
  }
  private value(x: number): number {
    const [lo, hi] = this.v.step.volumes[0].info.told;
    return lo + (Math.min(width - 1, Math.max(0, x)) / (width - 1)) * (hi - lo);
  }
  private y(o: number): number {
    return (height - 1) * (1 - o / this.most);
  }
  private at(e: MouseEvent): [number, number] {
    const r = this.canvas.getBoundingClientRect();
    return [e.clientX - r.left, e.clientY - r.top];
  }
  private nearest(e: MouseEvent): number {
    const [x, y] = this.at(e);
    let best = -1, least = reach;
    this.points.forEach(([v, o], i) => {
      const d = Math.hypot(this.x(v) - x, Math.min(height - 1, Math.max(0, this.y(o))) - y);
      if (d < least) least = d, best = i;
    });
    return best;
  }
  private press(e: PointerEvent): void {
    this.canvas.setPointerCapture(e.pointerId);
    this.held = this.nearest(e);
    if (this.held >= 0) return;
    const [x, y] = this.at(e), point: [number, number] = [this.value(x), this.opacity(y)];
    this.held = this.points.findIndex(([v]) => v > point[0]);
    if (this.held < 0) this.held = this.points.length;
    this.points.splice(this.held, 0, point);
    this.changed();
  }
  private opacity(y: number): number {
    return Math.min(1, Math.max(0, (1 - y / (height - 1)) * this.most));
  }
  private drag(e: PointerEvent): void {
    if (this.held < 0 || !e.buttons) return;
    const [x, y] = this.at(e), before = this.points[this.held - 1]?.[0] ?? -Infinity, after = this.points[this.held + 1]?.[0] ?? Infinity;
    this.points[this.held] = [Math.min(after, Math.max(before, this.value(x))), this.opacity(y)];
    this.changed();
  }
  private changed(): void {
    this.v.setOpacity(this.points.map(([x, o]) => [x, o] as [number, number]));
    this.paint();
  }

  paint(): void {
    const c = this.canvas.getContext("2d")!, volume = this.v.step.volumes[0], { histogram, told } = volume.info, n = histogram.length;
    c.clearRect(0, 0, width, height);
    const count = (x: number) => (this.logarithmic ? Math.log1p(x) : x), most = Math.max(1e-9, ...histogram.map(count));
    for (let i = 0; i < n; ++i) {
      const color = Array.from(volume.scale.color(told[0] + ((i + 0.5) / n) * (told[1] - told[0]))).slice(0, 3).map((x) => Math.round(255 * encodeSrgb(x))), high = (count(histogram[i]) / most) * (height - 4);
      c.fillStyle = cssColor(color);
      c.fillRect((i * width) / n, height - high, width / n + 0.5, high);
    }
    c.strokeStyle = "#111", c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(0, this.y(this.points[0]?.[1] ?? 0));
    for (const [v, o] of this.points) c.lineTo(this.x(v), this.y(o));
    c.lineTo(width, this.y(this.points.at(-1)?.[1] ?? 0));
    c.stroke();
    for (const [v, o] of this.points) {
      c.beginPath(), c.arc(this.x(v), Math.min(height - 1, Math.max(0, this.y(o))), 4.5, 0, 2 * Math.PI);
      c.fillStyle = "#fff", c.fill(), c.stroke();
    }
    this.words.value = `--show '${opacityWords(this.points)}'`;
  }
}
