// SPDX-License-Identifier: Apache-2.0
// A field over time at one place: the one that was clicked, or typed.
import type { App } from "../app";
import type { OverTimeAnswer, Vec3 } from "../protocol";

const seconds = 600; // a series is read through

export class OverTime {
  at: Vec3 | null = null;
  step = "";
  field = "";
  answer: OverTimeAnswer | null = null;
  asking = false;
  problem = "";

  constructor(private readonly app: App) {}

  /** Takes the step and the field that are shown, and the place that was clicked, where nothing else was said. */
  prepare(): void {
    const s = this.app.state;
    if (!s) return;
    const meshes = s.steps.filter((x) => x.kind !== "table");
    if (!meshes.some((x) => x.name === this.step)) this.step = s.show[0]?.of ?? meshes[0]?.name ?? "";
    const fields = this.fields();
    if (!fields.includes(this.field)) this.field = s.show.find((x) => x.of === this.step)?.transfer?.field ?? fields[0] ?? "";
    this.at ??= this.clicked;
  }

  fields(): string[] {
    return (this.app.session.step(this.step)?.fields ?? []).filter((f) => f.on !== "whole").map((f) => f.name);
  }

  get clicked(): Vec3 | null {
    return this.app.probe.pinned?.answer.position ?? null;
  }

  async ask(): Promise<void> {
    this.prepare();
    if (!this.at || this.asking) return;
    this.asking = true;
    this.app.changed();
    try {
      this.answer = await this.app.session.ask<OverTimeAnswer>({ do: "over_time", step: this.step, field: this.field, at: this.at }, seconds);
      this.problem = "";
    } catch (error) {
      this.problem = (error as Error).message;
    }
    this.asking = false;
    this.app.changed();
  }
}
