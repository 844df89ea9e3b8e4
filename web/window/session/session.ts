// SPDX-License-Identifier: Apache-2.0
// What the window knows of the session, and what it can ask for. Everything that changes ends in `changed`, which draws the panels anew.
import type { Camera, Cursor, Edit, FrameHeader, Problem, ServerMessage, Shown, State, Step } from "../protocol";
import { Edits } from "./edits";
import { Connection, Refused, type Connected } from "./socket";
import { wordsAt } from "./words_at";

export interface People {
  count: number;
  cursors: Cursor[];
  together: boolean; // all have one view
  camera: Camera | null; // that view, as it was told last
  led: boolean; // by this window
}

const nobody: People = { count: 1, cursors: [], together: false, camera: null, led: false };

export class Session {
  state: State | null = null;
  connected: Connected = "connecting";
  people: People = nobody;
  progress: { share: number; doing: string } | null = null;
  notes: string[] = [];
  private opened = false;
  private meet = (): void => undefined;
  /** Once the server has taken the connection, or not. */
  readonly met = new Promise<void>((resolve) => (this.meet = resolve));
  readonly edits = new Edits();
  /** The number of the last change that the server has not answered, or 0. */
  private changing = 0;
  readonly connection: Connection;

  constructor(
    url: string,
    private readonly changed: () => void,
    private readonly on: {
      frame: (header: FrameHeader, picture: Uint8Array) => void;
      state: (state: State, before: State | null) => void;
      restart: () => void;
      say: (text: string) => void;
      people: (people: People) => void;
      /** The first try to connect has failed. */
      neverOpened: () => void;
    },
  ) {
    this.connection = new Connection(url, {
      message: (m) => this.received(m),
      frame: (h, p) => this.on.frame(h, p),
      connected: (how) => this.connectedAs(how),
    });
  }

  /** Applies edits, all or none; `live` while something is dragged. */
  edit(edits: Edit[], live = false): void {
    if (!this.state?.may_edit) return;
    this.edits.put(edits, live);
    this.pump();
    this.changed();
  }

  /** Sets words of a step, of a way to show, of the picture, of a light, of the environment or of a node. */
  set(at: string, words: Record<string, string | null>, live = false): void {
    this.edit([{ at, set: words }], live);
  }

  /** A word as it will be once the server has answered; undefined: its default. */
  word(at: string, name: string): string | undefined {
    const draft = this.edits.draft(at, name);
    if (draft !== undefined) return draft ?? undefined;
    return this.wordsAt(at)[name];
  }

  wordsAt(at: string): Record<string, string> {
    return this.state ? wordsAt(this.state, at) : {};
  }

  step(name: string): Step | undefined {
    return this.state?.steps.find((s) => s.name === name);
  }

  shown(index: number): Shown | undefined {
    return this.state?.show[index];
  }

  undo(): void {
    if (this.state?.can_undo) this.change({ do: "undo" });
  }

  redo(): void {
    if (this.state?.can_redo) this.change({ do: "redo" });
  }

  setTime(time: number): void {
    this.change({ do: "time", time });
  }

  /** Whether the session is about to be another one. */
  get isChanging(): boolean {
    return this.changing > 0 || this.edits.waiting;
  }

  private change(request: { do: string } & Record<string, unknown>): number {
    const n = this.connection.send(request);
    if (n > 0) this.changing = n;
    this.changed();
    return n;
  }

  /** Replaces the whole pipeline by the text of a file. */
  async load(text: string): Promise<void> {
    await this.connection.ask({ do: "pipeline", text });
  }

  ask<T extends ServerMessage>(request: { do: string } & Record<string, unknown>, seconds?: number): Promise<T> {
    return this.connection.ask<T>(request, seconds);
  }

  /** Asks, and tells the person where the answer is no. */
  async askOrSay<T extends ServerMessage>(request: { do: string } & Record<string, unknown>): Promise<T | null> {
    try {
      return await this.ask<T>(request);
    } catch (error) {
      this.on.say((error as Error).message);
      return null;
    }
  }

  private received(m: ServerMessage): void {
    switch (m.is) {
      case "state": {
        const before = this.state;
        this.state = m;
        this.progress = null;
        this.answered(m.by ?? 0);
        this.edits.stateCame(m.by ?? 0);
        this.on.state(m, before);
        break;
      }
      case "refused":
        this.answered(m.n);
        this.edits.refused(m.n, m.errors);
        this.sayOthers(m.errors);
        break;
      case "progress":
        this.progress = m.share >= 1 ? null : { share: m.share, doing: m.doing };
        break;
      case "busy":
        this.progress = { share: 0, doing: "" };
        break;
      case "note":
        this.notes = [...this.notes.slice(-49), m.text];
        this.on.say(m.text);
        break;
      case "people":
        this.people = { count: m.count, cursors: m.cursors ?? [], together: m.together ?? false, camera: m.camera ?? null, led: m.led ?? false };
        this.on.people(this.people);
        break;
      default:
        break; // an answer that nobody waits for any more
    }
    this.pump();
    this.changed();
  }

  private answered(n: number): void {
    if (n >= this.changing) this.changing = 0;
  }

  /** Errors that stand at a control are read there; the others are said aloud. */
  private sayOthers(errors: Problem[]): void {
    const others = errors.filter((e) => e.word === "");
    if (others.length > 0) this.on.say(others.map((e) => e.text).join("; "));
  }

  private pump(): void {
    for (let batch = this.edits.next(); batch; batch = this.edits.next()) {
      const n = this.change({ do: "edit", live: batch.live, edits: batch.edits });
      this.edits.sent(n, batch);
      if (n === 0) {
        this.edits.lost();
        this.on.say("Not connected: the change was not made");
        return;
      }
    }
  }

  private connectedAs(how: Connected): void {
    const before = this.connected;
    this.connected = how;
    if (how === "open") this.opened = true;
    if (how !== "connecting") this.meet();
    if (how === "lost" && !this.opened) this.on.neverOpened();
    if (how === "lost") {
      this.changing = 0;
      this.edits.lost();
      this.progress = null;
      this.people = nobody;
    }
    if (how === "open" && before !== "open" && !this.connection.asksAtOnce) this.on.restart();
    this.changed();
  }
}

export { Refused };
