// SPDX-License-Identifier: Apache-2.0
// Playing the times of the data. The next one is asked for when the picture of the one before has been seen, so that none is skipped
// unseen; at most as often as the speed says.
import type { App } from "../app";
import type { View } from "../view/view";

export class Player {
  playing = false;
  speed = 5; // times per second
  loop = true;
  first = 0; // the range that is played, as numbers of times
  last = Infinity;
  private waitsFor = 0; // revision whose picture must be seen first
  private at = 0;

  constructor(private readonly app: App) {}

  get times(): number[] {
    return this.app.state?.times ?? [];
  }

  get end(): number {
    return Math.min(this.last, this.times.length - 1);
  }

  /** The number of the time that is nearest to the one shown. */
  get index(): number {
    return nearest(this.times, this.app.state?.time ?? 0);
  }

  go(index: number): void {
    const t = this.times[Math.max(0, Math.min(this.times.length - 1, index))];
    if (t === undefined || t === this.app.state?.time) return;
    this.app.session.setTime(t);
  }

  step(by: number): void {
    this.playing = false;
    this.go(this.index + by);
    this.app.changed();
  }

  toggle(): void {
    if (this.times.length < 2) return;
    this.playing = !this.playing;
    if (this.playing) {
      if (this.index >= this.end || this.index < this.first) this.go(this.first);
      this.next(0);
    }
    this.app.changed();
  }

  /** A picture has been drawn: the one that playing waits for? */
  drawn(view: View): void {
    if (!this.playing || this.waitsFor === 0 || view !== this.app.view) return;
    if ((view.frame?.revision ?? 0) >= this.waitsFor) this.next(this.at + 1000 / this.speed - performance.now());
  }

  private next(pause: number): void {
    this.waitsFor = 0;
    setTimeout(() => {
      if (!this.playing) return;
      const i = following(this.index, this.first, this.end, this.loop);
      if (i === null) {
        this.playing = false;
        this.app.changed();
        return;
      }
      this.at = performance.now();
      this.waitsFor = (this.app.state?.revision ?? 0) + 1;
      this.go(i);
    }, Math.max(0, pause));
  }
}

/** The number after i in [first, last]; at the end the first again, or null. */
export function following(i: number, first: number, last: number, loop: boolean): number | null {
  if (i < first) return first;
  if (i < last) return i + 1;
  return loop && last > first ? first : null;
}

export function nearest(times: number[], time: number): number {
  let best = 0;
  for (let i = 1; i < times.length; i++) if (Math.abs(times[i] - time) < Math.abs(times[best] - time)) best = i;
  return best;
}
