// SPDX-License-Identifier: Apache-2.0
// Values along a line between two points: dragged in the picture, or typed.
import { dataBounds } from "../camera/projection";
import type { App } from "../app";
import type { Drag } from "../input/pointer";
import type { LineAnswer, Vec3 } from "../protocol";
import type { View } from "../view/view";

const solid = new Set(["uniform", "rectilinear", "curvilinear", "unstructured", "amr"]);

export class Lines {
  from: Vec3 | null = null;
  to: Vec3 | null = null;
  step = "";
  field = "";
  count = 200;
  answer: LineAnswer | null = null;
  problem = "";
  /** The line as it is dragged, in CSS pixels of its view. */
  ruler: { view: number; a: [number, number]; b: [number, number] } | null = null;

  constructor(private readonly app: App) {}

  /** Takes the step and the field that are shown, and the diagonal of the data, where nothing else was said. */
  prepare(): void {
    const s = this.app.state;
    if (!s) return;
    // Along a line there are values in solids; of a surface it meets a point or two.
    if (!s.steps.some((x) => x.name === this.step))
      this.step = s.steps.find((x) => solid.has(x.kind ?? ""))?.name ?? s.show[0]?.of ?? s.steps[0]?.name ?? "";
    const fields = s.steps.find((x) => x.name === this.step)?.fields ?? [];
    if (!fields.some((f) => f.name === this.field))
      this.field = s.show.find((x) => x.of === this.step)?.transfer?.field ?? fields[0]?.name ?? "";
    const b = dataBounds(s);
    if (!this.from && b) {
      this.from = [b[0], (b[2] + b[3]) / 2, (b[4] + b[5]) / 2];
      this.to = [b[1], (b[2] + b[3]) / 2, (b[4] + b[5]) / 2];
    }
  }

  async ask(): Promise<void> {
    this.prepare();
    if (!this.from || !this.to) return;
    try {
      this.answer = await this.app.session.ask<LineAnswer>({
        do: "line",
        step: this.step,
        field: this.field,
        from: this.from,
        to: this.to,
        count: this.count,
      });
      this.problem = "";
    } catch (error) {
      this.problem = (error as Error).message;
    }
    this.app.changed();
  }

  drag(view: View, d: Drag, phase: "begin" | "drag" | "end"): boolean {
    this.ruler = { view: view.index, a: d.from, b: d.at };
    if (phase === "end") void this.finish(view, d.from, d.at);
    this.app.changed();
    return true;
  }

  private async finish(view: View, a: [number, number], b: [number, number]): Promise<void> {
    const [from, to] = await Promise.all([this.app.probe.at(view, a), this.app.probe.at(view, b)]);
    this.ruler = null;
    if (!from?.position || !to?.position) {
      this.app.say("A line begins and ends on something that is seen");
      this.app.changed();
      return;
    }
    this.from = from.position;
    this.to = to.position;
    this.app.open("plot");
    await this.ask();
  }
}
