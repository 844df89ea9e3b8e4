// SPDX-License-Identifier: Apache-2.0
// Edits on their way to the server. One is under way at a time, and while something is dragged only the newest waits behind it. Until the
// server has answered, controls show what was asked for, so that they do not jump back under the hand.
import type { Edit, Problem } from "../protocol";

interface Draft {
  value: string | null;
  n: number; // 0: not sent yet
  refused: boolean;
}

interface Batch {
  edits: Edit[];
  live: boolean;
}

const keyOf = (at: string, word: string): string => `${at} ${word}`;

export class Edits {
  private drafts = new Map<string, Draft>();
  private problems = new Map<string, string>();
  private underWay = 0;
  private queue: Batch[] = [];

  /** Adds an edit; a live one replaces the live one that waits before it, as far as it sets the same words. */
  put(edits: Edit[], live: boolean): void {
    for (const e of edits)
      if (sets(e))
        for (const [word, value] of Object.entries(e.set)) {
          this.drafts.set(keyOf(e.at, word), { value, n: 0, refused: false });
          this.problems.delete(keyOf(e.at, word));
        }
    const last = this.queue[this.queue.length - 1];
    if (last && last.live && merges(last.edits, edits)) {
      last.edits = merged(last.edits, edits);
      last.live = live;
    } else {
      this.queue.push({ edits, live });
    }
  }

  /** The edit to send, when none is under way. */
  next(): Batch | null {
    return this.underWay === 0 ? (this.queue.shift() ?? null) : null;
  }

  get waiting(): boolean {
    return this.queue.length > 0;
  }

  sent(n: number, batch: Batch): void {
    if (n === 0) return; // no connection: what was dragged meanwhile is lost, as the state that comes next says
    this.underWay = n;
    for (const e of batch.edits)
      if (sets(e))
        for (const word of Object.keys(e.set)) {
          const draft = this.drafts.get(keyOf(e.at, word));
          if (draft && draft.n === 0 && !this.waits(e.at, word)) draft.n = n;
        }
  }

  /** A state has come, made by the request `by`. */
  stateCame(by: number): void {
    this.problems.clear();
    for (const [key, draft] of this.drafts)
      if (draft.refused || (draft.n > 0 && draft.n <= by)) this.drafts.delete(key);
    if (this.underWay > 0 && by >= this.underWay) this.underWay = 0;
  }

  refused(n: number, errors: Problem[]): void {
    for (const e of errors) this.problems.set(keyOf(e.at, e.word), e.text);
    for (const draft of this.drafts.values()) if (draft.n === n && n > 0) draft.refused = true;
    if (n >= this.underWay) this.underWay = 0;
  }

  lost(): void {
    this.underWay = 0;
    this.queue = [];
    this.drafts.clear();
    this.problems.clear();
  }

  /** What is asked of a word, or undefined where nothing is. */
  draft(at: string, word: string): string | null | undefined {
    return this.drafts.get(keyOf(at, word))?.value;
  }

  problem(at: string, word: string): string | undefined {
    return this.problems.get(keyOf(at, word));
  }

  /** Objections that belong to no control of those that are seen. */
  others(seen: (at: string, word: string) => boolean): string[] {
    const list: string[] = [];
    for (const [key, text] of this.problems) {
      const space = key.lastIndexOf(" ");
      if (!seen(key.slice(0, space), key.slice(space + 1))) list.push(text);
    }
    return list;
  }

  private waits(at: string, word: string): boolean {
    return this.queue.some((b) => b.edits.some((e) => sets(e) && e.at === at && word in e.set));
  }
}

type Setting = Extract<Edit, { at: string; set: unknown }>;

const sets = (e: Edit): e is Setting => "at" in e && "set" in e;
const settings = (edits: Edit[]): edits is Setting[] => edits.every(sets);

function merges(before: Edit[], after: Edit[]): boolean {
  if (!settings(before) || !settings(after)) return false;
  const places = (edits: Setting[]): string => edits.map((e) => e.at).join(" ");
  return places(before) === places(after);
}

function merged(before: Edit[], after: Edit[]): Edit[] {
  return after.map((e, i) => {
    const b = before[i];
    return sets(e) && sets(b) ? { at: e.at, set: { ...b.set, ...e.set } } : e;
  });
}
