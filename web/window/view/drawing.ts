// SPDX-License-Identifier: Apache-2.0
// When a view asks for pictures and which of those that come are shown. No clock and no canvas here, so that tests can drive it.
import type { FrameHeader } from "../protocol";

/** Movement counts as ended after this many milliseconds without any. */
export const restAfter = 120;
/** A picture that has not come after this many milliseconds counts as dropped. */
export const droppedAfter = 1500;

export interface Sent {
  n: number;
  at: number;
}

export class Drawing {
  private sent: Sent | null = null; // the request whose first picture has not come
  private wanted = false;
  private movedAt = -Infinity;
  private resting = true; // the request for the still picture has been sent
  shown: { n: number; revision: number; coarse: number; final: boolean } | null = null;
  newest = 0; // number of the newest request
  private whole: { revision: number; of: [number, number] } | null = null; // the last picture that was not of a part alone

  /** The view has changed: by a hand that may go on, or once. */
  want(now: number, moving: boolean): void {
    this.wanted = true;
    this.resting = false;
    this.movedAt = moving ? now : -Infinity;
  }

  /** What to ask for at this moment: a quick picture, the still one, or nothing. Never more than one quick picture is under way. */
  due(now: number): "moving" | "still" | null {
    const moving = now - this.movedAt < restAfter;
    if (!moving) return this.resting ? null : "still";
    if (!this.wanted) return null;
    if (this.sent && now - this.sent.at < droppedAfter) return null;
    return "moving";
  }

  asked(n: number, now: number, how: "moving" | "still"): void {
    this.sent = { n, at: now };
    this.newest = n;
    this.wanted = false;
    if (how === "still") this.resting = true;
  }

  /** Whether a picture may be shown: none that is behind what is seen, in request, in revision or in sharpness. */
  fresh(frame: FrameHeader): boolean {
    if (this.sent && frame.n >= this.sent.n) this.sent = null;
    const s = this.shown;
    if (!s) return true;
    if (frame.n < s.n || frame.revision < s.revision) return false;
    if (frame.n === s.n && frame.revision === s.revision) return !s.final && frame.coarse <= s.coarse;
    return true;
  }

  show(frame: FrameHeader): void {
    this.shown = { n: frame.n, revision: frame.revision, coarse: frame.coarse, final: frame.final };
    if (!frame.part) this.whole = { revision: frame.revision, of: frame.of };
  }

  /** The revision of the whole picture of that size that is seen; 0: there is none. */
  base(width: number, height: number): number {
    const w = this.whole;
    return w && w.of[0] === width && w.of[1] === height ? w.revision : 0;
  }

  /** After the connection was lost numbers and revisions may begin again. */
  restart(): void {
    this.sent = null;
    this.shown = null;
    this.whole = null;
    this.want(-Infinity, false);
  }

  /** Whether what is seen is the last word on what was asked. */
  settled(revision: number): boolean {
    return this.resting && this.shown !== null && this.shown.final && this.shown.n >= this.newest && this.shown.revision >= revision;
  }
}
