// SPDX-License-Identifier: Apache-2.0
// What a page holds: the counterpart of src/pipeline/offline/pack/pack_*.cpp.

export interface ArrayInfo {
  type: "u8" | "u16" | "u32" | "f32";
  coding: "plain" | "differences" | "planes";
  stride: number;
  count: number;
}

export type Triple = [number, number, number];

export interface PositionsInfo {
  array: number;
  bits: number;
  lo: Triple;
  size: Triple;
  origin: Triple;
}

export interface NormalsInfo {
  array: number;
  bits: number;
}

export type ColorInfo =
  | { kind: "constant"; rgba: [number, number, number, number] }
  | { kind: "direct"; per_cell: boolean; colors: { array: number } }
  | {
      kind: "scale";
      per_cell: boolean;
      scale: number;
      nearest: boolean;
      positions: { array: number; bits: number; least: number; most: number };
    };

export interface ScaleInfo {
  kind: "linear" | "log" | "symlog";
  lo: number;
  hi: number;
  threshold: number;
  clamp: boolean;
  labels: number[];
  size: number;
  colors: number;
  below: number[];
  above: number[];
  nan: number[];
}

interface ItemBase {
  id: number;
  color: ColorInfo;
  opacity: number;
  material: [number, number, number, number];
  lit: boolean;
}

export interface SurfaceInfo extends ItemBase {
  kind: "surface";
  positions: PositionsInfo;
  triangles: number;
  normals?: NormalsInfo;
  corners?: number;
  translucent: boolean;
}

export interface LinesInfo extends ItemBase {
  kind: "lines";
  positions: PositionsInfo;
  segments: number;
  width: number;
  contrast: "none" | "darker" | "lighter";
  halo: number;
  halo_color: Triple;
  room?: number;
}

export interface PointsInfo extends ItemBase {
  kind: "points" | "discs";
  positions: PositionsInfo;
  size: number;
  normals?: NormalsInfo;
  radii?: number;
}

export interface GlyphsInfo extends ItemBase {
  kind: "glyphs" | "glyph_lines";
  places: PositionsInfo;
  matrices: number;
  largest: number;
  shapes: { positions: number; normals?: number }[];
  in_pixels: boolean;
  translucent: boolean;
  width: number;
  choice?: number;
}

export interface VolumeInfo {
  kind: "volume";
  mode: string;
  dims: Triple;
  samples: Triple;
  array: number;
  bits: 8 | 16;
  least: number;
  most: number;
  to_u: number[];
  origin: Triple;
  lo: Triple;
  hi: Triple;
  cells: boolean;
  nearest: boolean;
  scale: number;
  opacity: [number, number][];
  unit: number;
  edge: number;
  surface_from: number;
  levels: number[];
  lit: boolean;
  material: [number, number, number, number];
  field: string;
  told: [number, number];
  histogram: number[];
  clip: number[];
  left_out?: number;
}

export type ItemInfo = SurfaceInfo | LinesInfo | PointsInfo | GlyphsInfo | VolumeInfo;

export interface TickInfo {
  value: number;
  text: string;
  at: number;
  position: number | null;
}

export type Box = [number, number, number, number];
export type Rgba = [number, number, number, number];

export interface LegendInfo {
  place: "right" | "left" | "top" | "bottom";
  font: number;
  column: Box;
  title: string;
  title_size: number;
  title_wrap: number;
  title_centred: boolean;
  title_upwards: boolean;
  title_at: [number, number];
  title_extent: [number, number];
  bar: Box;
  ticks: TickInfo[];
  rows: string[];
  row_height: number;
  row_width: number;
  across: number;
  swatches: Rgba[];
  nan: boolean;
  nan_at: [number, number];
  nan_color: Rgba;
  above?: Rgba;
  below?: Rgba;
  colors?: number[];
  scale?: number;
  panel?: Box;
  opacity?: [number, number][];
  panel_texts?: [string, string, string];
  glyph?: Box;
  glyph_text?: string;
  glyph_arrow?: boolean;
  glyph_color?: Rgba;
}

export interface AxisInfo {
  name: string;
  letter: string;
  ticks: { at: number; text: string }[][];
}

export interface AnnotationInfo {
  width: number;
  height: number;
  area: Box;
  font: number;
  title: string;
  title_size: number;
  title_box: Box;
  caption: string;
  caption_height: number;
  axes: boolean;
  triad: boolean;
  letters: boolean;
  scale_bar: boolean;
  unit: string;
  stretch: Triple;
  dark: boolean;
  legends: LegendInfo[];
  notes: { text: string; place: string; size: number; at?: [number, number]; color?: Triple }[];
  texts: { text: string; at: Triple; along: Triple; size: number; color?: Triple }[];
  box?: [number, number, number, number, number, number];
  axis?: AxisInfo[];
  box_behind?: boolean;
}

export interface CameraInfo {
  position: Triple;
  target: Triple;
  up: Triple;
  angle: number;
  parallel: boolean;
  height: number;
}

export interface SceneInfo {
  sightglass: number;
  camera: CameraInfo;
  views: Record<string, { direction: Triple; up: Triple }>;
  margin: number;
  lights: { direction: Triple; follows: boolean; intensity: number }[];
  background: Triple;
  background_top: Triple;
  transparent: boolean;
  scales: ScaleInfo[];
  steps: { items: ItemInfo[]; annotation: AnnotationInfo; time?: number }[];
  arrays: ArrayInfo[];
  notes: string[];
}
