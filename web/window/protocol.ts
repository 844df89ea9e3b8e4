// SPDX-License-Identifier: Apache-2.0
// The messages between window and server, as docs/protocol.md describes them.

export type Vec3 = [number, number, number];

export interface Camera {
  position: Vec3;
  target: Vec3;
  up: Vec3;
  parallel: boolean;
  view_angle: number; // degrees, vertical
  height: number; // world length between the lower and the upper edge of a parallel picture
}

export type Words = Record<string, string>;

export interface FieldInfo {
  name: string;
  on: string;
  components: number;
  unit?: string;
  range?: [number, number] | null;
}

export interface Step {
  name: string;
  operation: string;
  words: Words;
  from: string[];
  kind?: string;
  size?: string;
  fields?: FieldInfo[];
  bytes?: number | null;
  seconds?: number | null;
}

export interface Histogram {
  range: [number, number];
  counts: number[];
}

export interface Transfer {
  field: string;
  unit?: string;
  range: [number, number];
  scale: string;
  map?: string;
  colors: string[];
  lightness?: number[];
  opacity?: [number, number][];
  opacity_unit?: number;
  histogram?: Histogram;
}

export interface Shown {
  kind: string;
  of: string;
  in?: string; // the node; "" where the data lie
  words: Words;
  transfer?: Transfer | null;
}

/** A light of the picture, or its environment. */
export interface Light {
  kind: string;
  words: Words;
}

/** A place in the scene, in which things are shown. */
export interface SceneNode {
  name: string;
  in: string; // the node that it stands in; "" for none
  words: Words;
  copies: number;
  copies_of: string; // the step at whose points the copies are; "" for none
  keys: number;
  copy_words: Words[]; // of the first ones
  points_words: Words; // of copies at points
  key_words: Words[];
}

export interface State {
  is: "state";
  revision: number;
  by?: number;
  can_undo: boolean;
  can_redo: boolean;
  title: string;
  saves: { types: string[]; most_pixels: number }; // of pictures that are saved
  may_edit: boolean;
  pipeline: string;
  command: string;
  steps: Step[];
  show: Shown[];
  picture: Words;
  lights: Light[];
  environment: Light | null;
  scene: SceneNode[];
  times: number[];
  time: number | null;
  bounds: [number, number, number, number, number, number] | null;
  stretch?: Vec3; // of the data in the picture, along each axis
  length_unit?: string;
  camera: Camera | null;
  notes: string[];
}

export type Edit =
  | { at: string; set: Record<string, string | null> }
  | { at: string; from: string[] }
  | { at: string; of: string }
  | { add: "step"; operation: string; from: string[]; before?: string[]; set: Words; show?: boolean }
  | { add: "show"; kind: string; of: string; in?: string; set: Words }
  | { add: "light" | "environment"; kind: string; set: Words }
  | { add: "node"; name: string; in: string; set: Words }
  | { add: "key" | "copy"; to: string; set: Words }
  | { add: "points"; to: string; of: string; set: Words }
  | { move: string; to: string }
  | { remove: string; join?: string[] };

export interface Problem {
  at: string;
  word: string;
  text: string;
}

export interface FrameHeader {
  is: "frame";
  n: number;
  view: number;
  revision: number;
  type: string;
  size: [number, number];
  of: [number, number];
  coarse: number;
  final: boolean;
  camera: Camera;
  area?: [number, number, number, number]; // where in `of` the camera looks: x, y, width, height; the rest is room of legends
  part?: boolean; // the picture is of `area` alone; the rest stays
  milliseconds: number;
  told?: string; // of pictures by paths of light: how exact it is
}

export interface ProbeAnswer {
  is: "probe";
  n: number;
  position: Vec3 | null;
  show?: number;
  values?: { name: string; value: string; unit?: string }[];
  cell?: number | null;
}

export interface RowsAnswer {
  is: "rows";
  n: number;
  total: number;
  columns: string[];
  rows: string[][];
}

export interface LineAnswer {
  is: "line";
  n: number;
  unit?: string;
  distance: number[];
  values: (number | null)[];
}

/** A step that makes the same selection. */
export interface SelectionStep {
  operation: string;
  set: Words;
}

export interface MeasuredField {
  name: string;
  on: string;
  component: number; // -1: the magnitude, or the only one
  unit: string;
  count: number;
  missing: number;
  min: number | null;
  max: number | null;
  mean: number | null;
  deviation: number | null;
  median: number | null;
  integral: number | null;
}

export interface MeasuresAnswer {
  is: "measures";
  n: number;
  points: number;
  cells: number;
  measure: number | null;
  dimension: number | null;
  length_unit: string;
  fields: MeasuredField[];
  steps: SelectionStep[];
}

export interface OverTimeAnswer {
  is: "over_time";
  n: number;
  unit?: string;
  times: number[];
  values: (number | null)[];
  gaps?: { time: number; text: string }[]; // times that could not be read
}

export interface Proposal {
  words: Words;
  reason: string;
}

export interface Cursor {
  id: number;
  view: number;
  at: [number, number];
  camera?: Camera;
}

/** Counts over the plane of value and second axis (else the gradient's magnitude), row by row from the smallest second value. */
export interface PlaneAnswer {
  is: "plane";
  n: number;
  value: [number, number];
  second: [number, number];
  size: [number, number];
  counts: number[];
}

/** A place of the data in that plane. */
export interface PlanePlaceAnswer {
  is: "plane";
  n: number;
  at: [number, number] | null;
}

export interface HistogramAnswer extends Histogram {
  is: "histogram";
  n: number;
}

export type ServerMessage =
  | State
  | { is: "refused"; n: number; errors: Problem[] }
  | ProbeAnswer
  | RowsAnswer
  | LineAnswer
  | MeasuresAnswer
  | OverTimeAnswer
  | PlaneAnswer
  | PlanePlaceAnswer
  | HistogramAnswer
  | { is: "saved"; n: number; url: string; name: string }
  | { is: "proposals"; n: number; list: Proposal[] }
  | { is: "progress"; share: number; doing: string }
  | { is: "busy"; revision: number }
  | { is: "note"; text: string }
  | { is: "people"; count: number; cursors: Cursor[]; together?: boolean; camera?: Camera; led?: boolean };

/** Splits a binary message into its header and its picture. */
export function splitFrame(message: ArrayBuffer): { header: FrameHeader; picture: Uint8Array } {
  if (message.byteLength < 4) throw new Error("A frame is shorter than the length of its header");
  const length = new DataView(message).getUint32(0, true);
  if (4 + length > message.byteLength) throw new Error("A frame ends within its header");
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, length))) as FrameHeader;
  return { header, picture: new Uint8Array(message, 4 + length) };
}
