// SPDX-License-Identifier: Apache-2.0
// The picture in the window: drawn coarsely at once while it moves, finely when it rests.
import { ArrayStore } from "./data/arrays";
import type { SceneInfo } from "./data/format";
import { type Area, Composer, type Quality } from "./draw/composer";
import type { GL } from "./draw/gl";
import { type Drawable, lampsOf, type Pass } from "./draw/pass";
import { loadScales, type Scale } from "./draw/scales";
import { BoxBehind, boundsOf, loadStep, type Step } from "./draw/step";
import { layoutOf, type Layout } from "./overlay/layout";
import { drawOverlay, LegendCache } from "./overlay/overlay";
import { Camera, centerOf } from "./view/camera";
import type { Vec3 } from "./view/vec";

const leastLevel = 2 ** -3.5, firstStride = 2, mostStride = 6;  // while it moves: samples per pixel along an axis, steps in those of the still picture
const frameTime = 28, leastDrawing = 5, mostDrawing = 15, restAfter = 180, bandTime = 40;  // milliseconds

export class Viewer {
  readonly camera: Camera;
  readonly first: Camera;
  /** Axes, numbers and the triad are drawn. */
  axes = true;
  step!: Step;
  number = 0;
  layout!: Layout;
  scales: Scale[] = [];
  /** Milliseconds of the last moving pictures. */
  readonly frameTimes: number[] = [];
  onStep: (() => void) | null = null;
  onStill: (() => void) | null = null;

  private readonly composer: Composer;
  private readonly context: CanvasRenderingContext2D;
  private readonly legends = new LegendCache();
  private readonly center: Vec3;
  private readonly steps: (Promise<Step> | undefined)[];
  private behind: BoxBehind | null = null;
  private coarse = 0;  // samples along an axis per pixel while it moves; 0: not known yet
  private level = 1;   // the one that is used
  private lastLevel = 0;
  private stride = firstStride;  // longer steps where fewer samples would show nothing
  private lastStart = 0;
  private lastDrawing = 0;
  private beside = frameTime - mostDrawing;  // milliseconds of a moving picture in which it is not drawn: overlay, the browser's own work
  private asked = 0;
  private rest = 0;
  private generation = 0;
  private ratio = 1;
  private moving = false;
  still = false;

  private constructor(private readonly gl: GL, readonly canvas: HTMLCanvasElement, readonly over: HTMLCanvasElement, readonly scene: SceneInfo, private readonly store: ArrayStore) {
    this.camera = new Camera(scene.camera), this.first = new Camera(scene.camera);
    this.composer = new Composer(gl, scene);
    this.context = over.getContext("2d")!;
    const start = scene.steps[0];
    this.center = centerOf(boundsOf(start.items, start.annotation));
    this.steps = scene.steps.map(() => undefined);
  }

  static async open(gl: GL, canvas: HTMLCanvasElement, over: HTMLCanvasElement, scene: SceneInfo, text: (n: number) => string): Promise<Viewer> {
    const store = new ArrayStore(scene.arrays, text), v = new Viewer(gl, canvas, over, scene, store);
    v.scales = await loadScales(gl, scene.scales, store);
    await v.show(0);
    return v;
  }

  async show(n: number): Promise<void> {
    const opacity = this.step?.volumes[0]?.points;
    this.number = n;
    this.steps[n] ??= loadStep(this.gl, this.scene, n, this.center, this.scales, this.store);
    const step = await this.steps[n]!;
    if (this.number !== n) return;
    this.step = step;
    if (opacity && step.volumes[0] && step.volumes[0].points !== opacity) step.volumes[0].setOpacity(opacity);
    this.behind = step.annotation.box_behind && step.box ? new BoxBehind(this.gl, step.box, this.center) : null;
    await this.behind?.load(this.store);
    this.resize();
    this.onStep?.();
  }

  /** To the window's size. */
  resize(): void {
    const width = Math.max(1, this.canvas.clientWidth), height = Math.max(1, this.canvas.clientHeight);
    this.ratio = Math.min(2, window.devicePixelRatio || 1);
    const w = Math.round(width * this.ratio), h = Math.round(height * this.ratio);
    if (this.over.width !== w || this.over.height !== h) this.over.width = w, this.over.height = h;
    this.layout = layoutOf(this.step.annotation, width, height);
    this.draw(this.step.volumes.length > 0);
  }

  aspect(): number {
    return this.layout.area.width / this.layout.area.height;
  }
  /** Width over height of the stated picture beside its legends. */
  private stated(): number {
    const [, , w, h] = this.step.annotation.area;
    return w / h;
  }
  projection(scale = 1) {
    const { area } = this.layout;
    const width = Math.max(1, Math.round(area.width * scale)), height = Math.max(1, Math.round(area.height * scale));
    return this.camera.projection(width, height, Math.min(this.stated(), 1.2), this.step.bounds);
  }

  /** As soon as the browser draws; while it is `moving` coarsely, and finely when it has rested for a while. */
  draw(moving: boolean): void {
    ++this.generation;
    this.still = false;
    this.moving = moving || (this.moving && this.asked !== 0);
    clearTimeout(this.rest);
    if (!this.asked) this.asked = requestAnimationFrame(() => {
      this.asked = 0;
      if (this.moving) {
        this.drawMoving();
        this.rest = window.setTimeout(() => { this.moving = false, this.drawStill(); }, restAfter);
      } else this.drawStill();
    });
  }

  /** Of the picture beside its legends, in a window of `r` pixels for each of the page's. */
  private area(r: number): Area {
    const { area, height } = this.layout;
    return { x: Math.round(area.x * r), y: Math.round((height - area.y - area.height) * r), width: Math.round(area.width * r), height: Math.round(area.height * r) };
  }

  private pass(samples: number, moving: boolean): { pass: Pass; drawables: Drawable[] } {
    const projection = this.projection(samples * this.ratio);
    const pass: Pass = { projection, center: this.center, samples: samples * this.ratio, lamps: lampsOf(this.scene, projection), peel: null, moving, soft: samples === 1 && !moving };
    const box = this.axes ? this.behind?.at(projection) : null;
    return { pass, drawables: box ? [...this.step.drawables, box] : this.step.drawables };
  }

  /** Coarse pictures come in a coarse window, which the browser makes larger: that costs least. */
  private present(samples: number): void {
    const r = this.ratio * Math.min(1, samples), w = Math.max(1, Math.round(this.layout.width * r)), h = Math.max(1, Math.round(this.layout.height * r));
    if (this.canvas.width !== w || this.canvas.height !== h) this.canvas.width = w, this.canvas.height = h;
    this.composer.present(w, h, this.area(r), Math.max(1, samples));
    const c = this.context;
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.clearRect(0, 0, this.layout.width, this.layout.height);
    drawOverlay(c, { annotation: this.step.annotation, layout: this.layout, projection: this.projection(), box: this.step.box, scales: this.scales, opacity: this.step.volumes[0]?.points ?? null, axes: this.axes, moving: this.moving && !this.still }, this.legends);
  }

  /** Milliseconds in which a moving picture is to be drawn, so that they follow each other by frameTime, if the browser lets them. */
  private drawingTime(): number {
    return Math.min(mostDrawing, Math.max(leastDrawing, frameTime - this.beside));
  }

  private drawMoving(): void {
    if (this.coarse === 0) this.coarse = this.level = this.step.volumes.length ? 2 ** -2.5 : 1;
    // Few sizes, and those kept for a while: targets of other sizes take time to make.
    if (this.coarse > 1.5 * this.level || this.coarse < 0.9 * this.level) this.level = 2 ** (Math.floor(2 * Math.log2(this.coarse)) / 2);
    const start = performance.now(), since = start - this.lastStart, samples = this.level, same = samples === this.lastLevel;
    const { pass, drawables } = this.pass(samples, true);
    this.composer.finish();  // of what the browser itself had to do
    const drawing = performance.now();
    const layers = this.composer.layersOf(pass, drawables, 3);
    this.composer.draw(pass, drawables, this.step.volumes, { samples, coarse: this.stride, layers });
    this.composer.finish();
    const time = performance.now() - drawing;
    this.present(samples);
    this.frameTimes.push(performance.now() - start);
    if (since < restAfter) this.beside += 0.2 * (since - this.lastDrawing - this.beside);
    this.lastStart = start, this.lastDrawing = time;
    if (this.frameTimes.length > 120) this.frameTimes.shift();
    this.lastLevel = samples;
    if (!same) return;  // new targets had to be made
    const allowed = this.drawingTime(), slow = time / allowed;
    const wanted = this.level * Math.min(2, Math.max(0.25, 1 / Math.sqrt(slow)));
    if (slow > 1.2 && this.level <= leastLevel * 1.01 && this.step.volumes.length) this.stride = Math.min(mostStride, this.stride * Math.min(1.5, slow));
    else if (slow < 0.8 && this.stride > firstStride) this.stride = Math.max(firstStride, this.stride * Math.max(0.8, slow));
    if (this.stride > firstStride) return;
    this.coarse = Math.min(1, Math.max(leastLevel, this.coarse + (slow > 2 ? 1 : 0.3) * (wanted - this.coarse)));
  }

  private stillQuality(): Quality {
    const surfaces = this.step.drawables.some((d) => d.stage === "surface");
    return { samples: surfaces ? 2 : this.step.volumes.length ? 1 : 3, coarse: 1, layers: 12 };
  }

  /** Volumes in bands of rows, so that the page answers while they are drawn. */
  private drawStill(): void {
    // First half as fine, where all of it would take long.
    const all = this.stillQuality();
    if (this.step.volumes.length && this.level < 0.5) this.drawFine({ ...all, samples: 0.5 }, () => this.drawFine(all, () => this.rested()));
    else this.drawFine(all, () => this.rested());
  }
  private rested(): void {
    this.still = true;
    this.onStill?.();
  }
  private drawFine(q: Quality, done: () => void): void {
    const generation = this.generation, { pass, drawables } = this.pass(q.samples, false);
    const height = pass.projection.height, through = drawables.some((d) => d.translucent);
    q = { ...q, layers: this.composer.layersOf(pass, drawables, q.layers) };
    const least = Math.ceil(height / (this.step.volumes.length ? 100 : 12));  // each band costs something by itself
    let row = 0, rows = this.step.volumes.length ? Math.max(4, Math.round(height / 40)) : through ? Math.ceil(height / 8) : height;
    const go = () => {
      if (generation !== this.generation) return;
      const start = performance.now(), end = Math.min(height, row + rows);
      this.composer.draw(pass, drawables, this.step.volumes, q, [row, end]);
      row = end;
      this.composer.finish();
      if (row < height) {
        rows = Math.max(least, Math.round(rows * Math.min(2, Math.max(0.5, bandTime / (performance.now() - start)))));
        requestAnimationFrame(go);
        return;
      }
      this.present(q.samples);
      done();
    };
    go();
  }

  setOpacity(points: [number, number][]): void {
    for (const v of this.step.volumes) v.setOpacity(points);
    this.draw(true);
  }

  /** The window's picture with all that is written over it. */
  snapshot(): HTMLCanvasElement {
    const out = document.createElement("canvas"), c = out.getContext("2d")!;
    out.width = this.canvas.width, out.height = this.canvas.height;
    const q = this.stillQuality(), { pass, drawables } = this.pass(q.samples, false);
    if (!this.still) this.composer.draw(pass, drawables, this.step.volumes, { ...q, layers: this.composer.layersOf(pass, drawables, q.layers) });
    this.present(q.samples);
    c.drawImage(this.canvas, 0, 0), c.drawImage(this.over, 0, 0);
    return out;
  }
}
