// SPDX-License-Identifier: Apache-2.0
// Numbers of a part of the data: selected by value, by a box, or by an outline that is drawn in the picture.
import type { App, Tool } from "../app";
import type { Drag } from "../input/pointer";
import { simplified } from "../measure/geometry";
import type { Camera, FieldInfo, MeasuresAnswer, SelectionStep, State, Step, Vec3 } from "../protocol";
import type { View } from "../view/view";
import { csv } from "./files";

type Pixel = [number, number];

/** An outline in CSS pixels of its view, and the camera that saw it. */
interface Outline {
  view: number;
  camera: Camera | null;
  points: Pixel[];
}

const seconds = 120; // for large data

export class Selections {
  step = "";
  valueField = "";
  range: [number, number] | null = null; // null: by no value
  box: number[] | null = null;
  outline: Outline | null = null;
  answer: MeasuresAnswer | null = null;
  problem = "";
  asking = false;
  /** The outline as the server placed it in the data: it stays there when the camera moves. */
  private region: { lasso: Vec3[]; eye: Vec3 | null } | null = null;
  private drawing: Outline | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private asked = "";

  constructor(private readonly app: App) {}

  get hasOutline(): boolean {
    return this.outline !== null || this.region !== null;
  }

  /** Takes the step that is shown where no other was chosen. */
  prepare(): void {
    const s = this.app.state;
    if (!s) return;
    const meshes = s.steps.filter((x) => x.kind !== "table");
    if (!meshes.some((x) => x.name === this.step)) this.step = s.show[0]?.of ?? meshes[0]?.name ?? "";
    const fields = this.fields();
    if (!fields.some((f) => f.name === this.valueField)) {
      this.valueField = s.show.find((x) => x.of === this.step)?.transfer?.field ?? fields[0]?.name ?? "";
      this.range = null;
    }
    // What was asked of another state of the session is asked anew, once it rests.
    if (this.answer && this.key(s) !== this.asked && !this.app.session.isChanging) this.soon();
  }

  fields(): FieldInfo[] {
    return (this.app.session.step(this.step)?.fields ?? []).filter((f) => f.on !== "whole");
  }

  /** The range of the field by which is selected. */
  get valueRange(): [number, number] {
    return this.fields().find((f) => f.name === this.valueField)?.range ?? [0, 1];
  }

  change(what: Partial<Pick<Selections, "step" | "valueField" | "range" | "box">>): void {
    Object.assign(this, what);
    this.soon();
    this.app.changed();
  }

  clearOutline(): boolean {
    if (!this.hasOutline && !this.drawing) return false;
    this.outline = this.drawing = this.region = null;
    this.soon();
    this.app.changed();
    return true;
  }

  /** A box around all of the data, to begin with. */
  boxOfData(): number[] {
    const s = this.app.state;
    const [x0, x1, y0, y1, z0, z1] = s?.bounds ?? [0, 1, 0, 1, 0, 1];
    const stretch = s?.stretch ?? [1, 1, 1];
    const reach = Math.max(x1 - x0, y1 - y0, z1 - z0) || 1;
    return [[x0, x1], [y0, y1], [z0, z1]].flatMap(([a, b], i) => (b > a ? [a / stretch[i], b / stretch[i]] : [a / stretch[i] - reach / 2, b / stretch[i] + reach / 2]));
  }

  /** Everything that a view shows. */
  allSeen(view: View): void {
    const { x, y, width, height } = view.area;
    this.take(view, [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]);
  }

  drag(view: View, d: Drag, phase: "begin" | "drag" | "end", tool: Tool): boolean {
    if (phase === "begin" || !this.drawing) this.drawing = { view: view.index, camera: view.camera, points: [d.from] };
    const [[x0, y0], [x1, y1]] = [d.from, d.at];
    this.drawing.points = tool === "rectangle" ? [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] : [...this.drawing.points, d.at];
    if (phase === "end") {
      const { points } = this.drawing;
      this.drawing = null;
      const few = simplified(points, 0.75);
      if (few.length > 2) this.take(view, few);
    }
    this.app.changed();
    return true;
  }

  /** The corners of the outline in a view: while it is drawn, and as long as the camera is where it was then. */
  outlineIn(view: View): Pixel[] {
    const o = this.drawing ?? this.outline;
    if (!o || o.view !== view.index || JSON.stringify(o.camera) !== JSON.stringify(view.camera)) return [];
    return o.points;
  }

  private take(view: View, points: Pixel[]): void {
    this.outline = { view: view.index, camera: view.camera, points };
    this.region = null;
    this.app.open("numbers");
    void this.ask();
  }

  private soon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.ask(), 250);
  }

  private key(s: State): string {
    return JSON.stringify([s.revision, s.time, this.step, this.range && [this.valueField, this.range], this.box, this.region ?? this.outline?.points]);
  }

  async ask(): Promise<void> {
    clearTimeout(this.timer);
    const s = this.app.state;
    if (!s) return;
    if (this.asking) return this.soon();
    this.asking = true;
    this.app.changed();
    try {
      const among = await this.among();
      const key = (): string => this.key(s);
      const before = key();
      const answer = await this.app.session.ask<MeasuresAnswer>({ do: "measures", step: this.step, among }, seconds);
      const placed = before === key();
      if (placed && this.outline && !this.region) this.region = regionOf(answer.steps);
      this.asked = placed ? key() : before;
      this.answer = answer;
      this.problem = "";
    } catch (error) {
      this.problem = (error as Error).message;
      this.asked = this.key(s);
    }
    this.asking = false;
    this.app.changed();
  }

  private async among(): Promise<Record<string, unknown>> {
    const among: Record<string, unknown> = {};
    if (this.range) among.value = { field: this.valueField, range: this.range };
    if (this.box) among.box = this.box;
    if (this.region) {
      among.lasso = this.region.lasso;
      if (this.region.eye) among.lasso_eye = this.region.eye;
    } else if (this.outline) {
      const view = this.app.views[this.outline.view];
      await this.pictureOf(view);
      among.view = view.index;
      among.lasso = this.outline.points.map((p) => view.toPicture(p));
    }
    return among;
  }

  /** The server knows where pixels lie in the data once it has drawn the whole picture. */
  private async pictureOf(view: View): Promise<void> {
    for (let tries = 0; tries < 200 && !view.drawing.settled(this.app.state?.revision ?? 0); tries++) await new Promise((go) => setTimeout(go, 50));
  }

  /** Adds the steps that make the same selection, and shows the last. */
  async addSteps(): Promise<void> {
    let from = this.step;
    const steps = this.answer?.steps ?? [];
    for (const [i, s] of steps.entries()) {
      const known = new Set((this.app.state?.steps ?? []).map((x: Step) => x.name));
      try {
        const state = await this.app.session.ask<State>({ do: "edit", edits: [{ add: "step", operation: s.operation, from: [from], set: s.set, show: i === steps.length - 1 }] }, seconds);
        from = state.steps.find((x) => !known.has(x.name))?.name ?? from;
      } catch (error) {
        this.app.say((error as Error).message);
        return;
      }
    }
    this.app.open("steps");
  }

  csv(): string {
    const fields = this.answer?.fields ?? [];
    return csv(
      ["field", "on", "component", "unit", "count", "missing", "min", "max", "mean", "deviation", "median", "integral"],
      fields.map((f) => [f.name, f.on, f.component < 0 ? "" : f.component, f.unit, f.count, f.missing, f.min, f.max, f.mean, f.deviation, f.median, f.integral]),
    );
  }
}

/** The outline in space that the words of a step describe. */
export function regionOf(steps: SelectionStep[]): { lasso: Vec3[]; eye: Vec3 | null } | null {
  const words = steps.find((s) => s.set.lasso)?.set;
  if (!words) return null;
  const n = words.lasso.split(",").map(Number);
  const lasso = Array.from({ length: Math.floor(n.length / 3) }, (_, i) => n.slice(3 * i, 3 * i + 3) as Vec3);
  return { lasso, eye: words.lasso_eye ? (words.lasso_eye.split(",").map(Number) as Vec3) : null };
}
