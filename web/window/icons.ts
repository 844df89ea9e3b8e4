// SPDX-License-Identifier: Apache-2.0
// Icons, drawn with lines in a square of 20.
import { svg, html, type TemplateResult } from "lit";

const paths: Record<string, string> = {
  undo: "M7 4L3 8l4 4M3 8h9a5 5 0 0 1 0 10H8",
  redo: "M13 4l4 4-4 4M17 8H8a5 5 0 0 0 0 10h4",
  add: "M10 4v12M4 10h12",
  save: "M10 3v9M6 9l4 4 4-4M3 15v2h14v-2",
  dark: "M16 12A7 7 0 1 1 8 4a5.5 5.5 0 0 0 8 8z",
  light: "M10 6.5a3.5 3.5 0 1 1 0 7 3.5 3.5 0 0 1 0-7zM10 2v2M10 16v2M2 10h2M16 10h2M4.3 4.3l1.4 1.4M14.3 14.3l1.4 1.4M15.7 4.3l-1.4 1.4M5.7 14.3l-1.4 1.4",
  full: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4",
  help: "M7 7.5a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M10 15.5v.5",
  panel: "M3 4h14v12H3zM12 4v12",
  turn: "M15.5 6A7 7 0 1 0 17 10M16 2.5V6.5H12",
  pan: "M10 2v16M2 10h16M7.5 4.5L10 2l2.5 2.5M7.5 15.5L10 18l2.5-2.5M4.5 7.5L2 10l2.5 2.5M15.5 7.5L18 10l-2.5 2.5",
  zoom: "M8.5 3a5.5 5.5 0 1 1 0 11 5.5 5.5 0 0 1 0-11zM12.5 12.5L17 17M6 8.5h5M8.5 6v5",
  window: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  line: "M4 16L16 4M2.5 14.5l3 3M14.5 2.5l3 3",
  measure: "M2.5 13.5L13.5 2.5l4 4L6.5 17.5zM6 10l2 2M9 7l2 2M12 4l2 2",
  rectangle: "M3 5h2M8 5h4M15 5h2v2M17 10v3M17 15h-2M12 15H8M5 15H3v-2M3 10V7",
  lasso: "M10 4c4.5 0 7.5 1.8 7.5 4.5S14.5 13 10 13S2.5 11.200 2.5 8.500S5.5 4 10 4zM6 12.5c-1.5 1-1 3 .5 3s2 1.5.5 2.5",
  cube: "M10 2l7 4v8l-7 4-7-4V6zM3 6l7 4 7-4M10 10v8",
  perspective: "M6 5h8l3 11H3zM4.6 10h10.8",
  parallel: "M6 5h11l-3 11H3zM4.6 10h11",
  home: "M3 10l7-6 7 6M5 8.5V16h10V8.5",
  one: "M3 4h14v12H3z",
  two: "M3 4h14v12H3zM10 4v12",
  four: "M3 4h14v12H3zM10 4v12M3 10h14",
  planes: "M10 2v16M2 10h16M10 10m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0",
  link: "M8.5 11.5l3-3M9 6.5l1.8-1.8a3.2 3.2 0 0 1 4.5 4.5L13.5 11M11 13.5l-1.8 1.8a3.2 3.2 0 0 1-4.5-4.5L6.5 9",
  back: "M13 4L6 10l7 6zM5 4v12",
  on: "M7 4l7 6-7 6zM15 4v12",
  play: "M6 3.5l10 6.5-10 6.5z",
  pause: "M6 4v12M7 4v12M13 4v12M14 4v12",
  close: "M5 5l10 10M15 5L5 15",
  reset: "M5 6a7 7 0 1 1-2 5M5 2.5V6.5h4",
  eye: "M2 10c3-5 5.5-6 8-6s5 1 8 6c-3 5-5.5 6-8 6s-5-1-8-6zM10 7.5a2.5 2.5 0 1 1 0 5 2.5 2.5 0 0 1 0-5z",
  hidden: "M2 10c3-5 5.5-6 8-6s5 1 8 6c-3 5-5.5 6-8 6s-5-1-8-6zM4 17L16 3",
  left: "M12 5l-5 5 5 5",
  right: "M8 5l5 5-5 5",
};

export function icon(name: string): TemplateResult {
  return html`<svg class="icon-drawing" viewBox="0 0 20 20" aria-hidden="true">${svg`<path d=${paths[name] ?? ""} />`}</svg>`;
}
