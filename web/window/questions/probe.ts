// SPDX-License-Identifier: Apache-2.0
// What lies under the pointer: asked while it rests, one question at a time; a click keeps the answer.
import type { App } from "../app";
import type { ProbeAnswer } from "../protocol";
import type { View } from "../view/view";

export interface Pinned {
  view: number;
  at: [number, number];
  answer: ProbeAnswer;
}

export class Probe {
  current: { at: [number, number]; view: number; answer: ProbeAnswer } | null = null;
  pinned: Pinned | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private asking = false;
  private next: { view: View; at: [number, number] } | null = null;

  constructor(private readonly app: App) {}

  hover(view: View, at: [number, number] | null): void {
    clearTimeout(this.timer);
    if (!at) {
      this.next = null;
      if (this.current) {
        this.current = null;
        this.app.changed();
      }
      return;
    }
    this.next = { view, at };
    this.timer = setTimeout(() => void this.askNext(), 90);
  }

  /** Asks about a place in a view, in CSS pixels; `keep`: the answer is wanted even when another place is asked about meanwhile. */
  async at(view: View, at: [number, number], keep = true): Promise<ProbeAnswer | null> {
    try {
      return await this.app.session.ask<ProbeAnswer>({ do: "probe", view: view.index, at: view.toPicture(at), ...(keep ? { keep } : {}) });
    } catch {
      return null;
    }
  }

  async click(view: View, at: [number, number]): Promise<void> {
    const answer = await this.at(view, at);
    this.pinned = answer && answer.position ? { view: view.index, at, answer } : null;
    this.app.changed();
  }

  /** The number that was clicked of a field, for transfer functions and lists of values. */
  valueOf(field: string | undefined): number | null {
    const values = this.pinned?.answer.values ?? [];
    const v = values.find((x) => x.name === field) ?? (field === undefined ? values[0] : undefined);
    const x = v ? magnitude(v.value) : NaN;
    return Number.isFinite(x) ? x : null;
  }

  private async askNext(): Promise<void> {
    if (this.asking || !this.next) return;
    const { view, at } = this.next;
    this.next = null;
    this.asking = true;
    const answer = await this.at(view, at, false);
    this.asking = false;
    this.current = answer ? { at, view: view.index, answer } : null;
    this.app.changed();
    if (this.next) void this.askNext();
  }
}

/** A value of a probe as colours see it: of several components, "(1, 2, 2)", the magnitude. */
export function magnitude(text: string): number {
  const parts = text.replace(/^\(|\)$/g, "").split(",").map(Number);
  return parts.length === 1 ? parts[0] : Math.hypot(...parts);
}

/** A probe's answer as one line. */
export function probeText(answer: ProbeAnswer, lengthUnit = ""): string {
  if (!answer.position) return "nothing here";
  const place = answer.position.map((x) => String(Number(x.toPrecision(5)))).join(", ");
  const values = (answer.values ?? []).map((v) => `${v.name} ${v.value}${v.unit ? ` ${v.unit}` : ""}`);
  const cell = answer.cell !== null && answer.cell !== undefined ? [`cell ${answer.cell}`] : [];
  return [...values, ...cell, `(${place})${lengthUnit ? ` ${lengthUnit}` : ""}`].join(" · ");
}
