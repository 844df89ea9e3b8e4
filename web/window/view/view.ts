// SPDX-License-Identifier: Apache-2.0
// One view: its camera, its canvas, and the pictures that it asks for.
import { drag as turnBall, roll, turn } from "../camera/trackball";
import { pan, zoom } from "../camera/camera";
import type { Size } from "../camera/projection";
import { listen, type Drag, type PointerHandlers } from "../input/pointer";
import type { Camera, FrameHeader } from "../protocol";
import type { Connection, Request } from "../session/socket";
import { Canvas } from "./canvas";
import { Drawing } from "./drawing";

export interface Area extends Size {
  x: number;
  y: number;
}

/** What a view needs of the window around it. */
export interface Host {
  connection: Connection;
  tool: () => string;
  moved: (view: View, before: Camera, after: Camera) => void;
  asked: () => void;
  drawn: (view: View) => void;
  click: (view: View, at: [number, number], button: string) => void;
  hover: (view: View, at: [number, number] | null) => void;
  toolDrag: (view: View, drag: Drag, phase: "begin" | "drag" | "end") => boolean;
}

export class View {
  readonly element: HTMLDivElement;
  readonly overlay = document.createElement("div");
  readonly drawing = new Drawing();
  readonly canvas: Canvas;
  camera: Camera | null = null;
  frame: FrameHeader | null = null; // the one that is seen
  size: Size = { width: 0, height: 0 };
  private dragHow: "turn" | "pan" | "zoom" | "tool" = "turn";
  private requested = false;

  constructor(
    readonly index: number,
    private readonly host: Host,
  ) {
    const e = document.createElement("div");
    e.className = "view-surface";
    e.tabIndex = 0;
    e.setAttribute("role", "application");
    e.setAttribute("aria-roledescription", "three-dimensional picture");
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    this.overlay.className = "overlay-holder";
    e.append(canvas, this.overlay);
    this.element = e;
    this.canvas = new Canvas(canvas, this.drawing, (frame, drawn) => this.received(frame, drawn));
    listen(e, this.pointerHandlers());
    new ResizeObserver(() => this.measure()).observe(e);
  }

  /** Sets the camera; `moving` while a hand turns it. */
  look(camera: Camera, moving: boolean, tell = true): void {
    const before = this.camera;
    this.camera = camera;
    this.drawing.want(performance.now(), moving);
    if (before && tell) this.host.moved(this, before, camera);
    this.schedule();
  }

  /** The request for the first picture, which counts as sent, as number 1; undefined where the view has no size yet. */
  first(): Request | undefined {
    this.measure();
    if (this.size.width === 0) return undefined;
    this.drawing.asked(1, performance.now(), "still");
    return this.request(false);
  }

  private request(moving: boolean): Request {
    const c = this.canvas.element;
    return {
      do: "draw",
      view: this.index,
      size: [c.width, c.height],
      scale: window.devicePixelRatio || 1,
      ...(this.camera ? { camera: this.camera } : {}),
      moving,
      base: this.drawing.base(c.width, c.height),
    };
  }

  /** Draws the same view again, as after a change of its size. */
  redraw(moving = false): void {
    this.drawing.want(performance.now(), moving);
    this.schedule();
  }

  restart(): void {
    this.drawing.restart();
    this.schedule();
  }

  /** Place in the view, in CSS pixels, as pixels of the picture. */
  toPicture(at: [number, number]): [number, number] {
    const of = this.frame?.of ?? [this.canvas.element.width, this.canvas.element.height];
    return [(at[0] / this.size.width) * of[0], (at[1] / this.size.height) * of[1]];
  }

  /** The part of the view in which the camera looks, in CSS pixels: beside it there may be legends. */
  get area(): Area {
    const { area, of } = this.frame ?? {};
    if (!area || !of) return { x: 0, y: 0, ...this.size };
    const kx = this.size.width / of[0];
    const ky = this.size.height / of[1];
    return { x: area[0] * kx, y: area[1] * ky, width: area[2] * kx, height: area[3] * ky };
  }

  get aspect(): number {
    const a = this.area;
    return a.height > 0 ? a.width / a.height : 1.4;
  }

  private received(frame: FrameHeader, drawn: boolean): void {
    if (drawn) this.frame = frame;
    this.host.connection.tell({ do: "shown", n: frame.n, view: this.index, base: this.drawing.base(this.canvas.element.width, this.canvas.element.height) });
    if (drawn && !this.camera) this.camera = frame.camera;
    this.host.drawn(this);
    this.schedule();
  }

  private measure(): void {
    const box = this.element.getBoundingClientRect();
    if (box.width < 1 || box.height < 1) return;
    this.size = { width: box.width, height: box.height };
    const ratio = window.devicePixelRatio || 1;
    if (this.canvas.resize(Math.round(box.width * ratio), Math.round(box.height * ratio))) this.redraw();
  }

  private schedule(): void {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame((now) => {
      this.requested = false;
      this.step(now);
    });
  }

  private step(now: number): void {
    if (!this.element.isConnected || this.size.width === 0 || !this.host.connection.isOpen) return;
    const how = this.drawing.due(now);
    if (how) {
      const n = this.host.connection.send(this.request(how === "moving"));
      if (n > 0) this.drawing.asked(n, now, how);
      this.host.asked();
    }
    if (how !== "still" && this.drawing.due(now + 1e9) !== null) this.schedule();
  }

  private pointerHandlers(): PointerHandlers {
    const unit = (p: [number, number]): [number, number] => {
      const a = this.area;
      const h = a.height / 2;
      return [(p[0] - a.x - a.width / 2) / h, (a.y + h - p[1]) / h];
    };
    return {
      begin: (d) => {
        const tool = this.host.tool();
        if (d.button === "middle" || d.shift) this.dragHow = "pan";
        else if (d.button === "right" || d.control) this.dragHow = "zoom";
        else if (this.host.toolDrag(this, d, "begin")) this.dragHow = "tool";
        else this.dragHow = tool === "pan" || tool === "zoom" ? tool : "turn";
        this.element.classList.add("dragging");
      },
      drag: (d) => {
        if (this.dragHow === "tool") return void this.host.toolDrag(this, d, "drag");
        const c = this.camera;
        if (!c) return;
        const h = this.area.height;
        if (this.dragHow === "pan") this.look(pan(c, d.moved[0] / h, -d.moved[1] / h), true);
        else if (this.dragHow === "zoom") this.look(zoom(c, Math.exp((-d.moved[1] / h) * 3)), true);
        else this.look(turnBall(c, unit([d.at[0] - d.moved[0], d.at[1] - d.moved[1]]), unit(d.at)), true);
      },
      end: (d) => {
        this.element.classList.remove("dragging");
        if (this.dragHow === "tool") this.host.toolDrag(this, d, "end");
      },
      click: (at, button) => this.host.click(this, at, button),
      pinch: ({ at, moved, factor, angle }) => {
        if (!this.camera) return;
        const h = this.area.height;
        const [x, y] = unit(at);
        const panned = pan(this.camera, moved[0] / h, -moved[1] / h);
        this.look(roll(zoom(panned, factor, x / 2, y / 2), -angle), true);
      },
      wheel: (at, factor) => {
        if (!this.camera) return;
        const [x, y] = unit(at);
        this.look(zoom(this.camera, factor, x / 2, y / 2), true);
      },
      hover: (at) => this.host.hover(this, at),
    };
  }

  /** What the keys of a view do; false where the action is none of them. */
  act(action: string): boolean {
    const c = this.camera;
    if (!c) return false;
    const by = Math.PI / 18;
    const turns: Record<string, () => Camera> = {
      "turn-left": () => turn(c, [0, 1, 0], -by),
      "turn-right": () => turn(c, [0, 1, 0], by),
      "turn-up": () => turn(c, [1, 0, 0], -by),
      "turn-down": () => turn(c, [1, 0, 0], by),
      "roll-left": () => roll(c, by),
      "roll-right": () => roll(c, -by),
      "pan-left": () => pan(c, -0.05, 0),
      "pan-right": () => pan(c, 0.05, 0),
      "pan-up": () => pan(c, 0, 0.05),
      "pan-down": () => pan(c, 0, -0.05),
      "zoom-in": () => zoom(c, 1.15),
      "zoom-out": () => zoom(c, 1 / 1.15),
    };
    const next = turns[action];
    if (!next) return false;
    this.look(next(), true);
    return true;
  }
}
