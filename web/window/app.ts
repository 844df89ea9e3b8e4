// SPDX-License-Identifier: Apache-2.0
// The window: its session, its views, and what is selected in it. The panels draw themselves from this.
import { fit, namedViews, toggleProjection, upIsY } from "./camera/camera";
import { noCatalog, type Catalog } from "./catalog";
import type { Drag } from "./input/pointer";
import { Commands } from "./input/commands";
import type { Camera, State } from "./protocol";
import type { Connecting } from "./panels/ports";
import { Rulers } from "./measure/rulers";
import { Lines } from "./questions/lines";
import { OverTime } from "./questions/over_time";
import { Selections } from "./questions/selections";
import { Probe } from "./questions/probe";
import { Histograms } from "./questions/histograms";
import { Company } from "./session/company";
import { Player } from "./session/player";
import { selectionAfter } from "./session/selection";
import { Session } from "./session/session";
import { levelDrag } from "./view/window_level";
import { follow, type Link } from "./view/link";
import { View } from "./view/view";

export type Tab = "steps" | "look" | "scene" | "color" | "table" | "plot" | "numbers" | "file";
export type Tool = "turn" | "pan" | "zoom" | "window" | "line" | "measure" | "lasso" | "rectangle";
export type Dialog = "help" | "add" | "save" | "legend" | null;

export class App {
  /** What can be requested; empty until it has come. */
  catalog: Catalog = noCatalog;
  readonly session: Session;
  readonly views: View[] = [];
  readonly probe: Probe;
  readonly lines: Lines;
  readonly overTime: OverTime;
  readonly selections: Selections;
  readonly rulers: Rulers;
  readonly histograms: Histograms;
  readonly player: Player;
  readonly commands: Commands;
  readonly company: Company;
  layout: 1 | 2 | 4 = 1;
  link: Link = "place";
  active = 0;
  tool: Tool = "turn";
  tab: Tab = "look";
  panelOpen = window.innerWidth > 700;
  selected = "show/0"; // of show/N, steps/NAME, lights/N, scene/NAME, picture
  dialog: Dialog = null;
  /** Places that take the selected step, and what is added next in its place. */
  inFront: string[] = [];
  /** The edge that is being drawn in the graph. */
  connecting: Connecting | null = null;
  message = "";
  /** The pipeline as it was when the window opened. */
  beginning = "";
  private drawn = false;
  private messageTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    url: string,
    private readonly render: (app: App) => void,
    neverOpened: () => void = () => undefined,
  ) {
    this.session = new Session(url, () => this.changed(), {
      frame: (header, picture) => void this.views[header.view]?.canvas.receive(header, picture),
      state: (state, before) => this.stateCame(state, before),
      restart: () => this.views.forEach((v) => v.restart()),
      say: (text) => this.say(text),
      neverOpened,
      people: () => this.company.peopleCame(),
    });
    this.company = new Company(this);
    this.probe = new Probe(this);
    this.lines = new Lines(this);
    this.overTime = new OverTime(this);
    this.selections = new Selections(this);
    this.rulers = new Rulers(this);
    this.histograms = new Histograms(this);
    this.player = new Player(this);
    this.commands = new Commands(this);
    this.views.push(this.makeView(0));
    document.addEventListener("fullscreenchange", () => this.changed());
  }

  /** Connects, once the window stands on the page: what the first view is to show is asked for with the address. */
  connect(): void {
    this.session.connection.open(this.views[0].first());
  }

  /** Draws the panels anew, at most once per frame of the screen. */
  changed(): void {
    if (this.drawn) return;
    this.drawn = true;
    requestAnimationFrame(() => {
      this.drawn = false;
      this.render(this);
    });
  }

  /** Tells the person something, also those who listen to the screen. */
  say(text: string): void {
    this.message = text;
    clearTimeout(this.messageTimer);
    this.messageTimer = setTimeout(() => {
      this.message = "";
      this.changed();
    }, 8000);
    this.changed();
  }

  get state(): State | null {
    return this.session.state;
  }

  get view(): View {
    return this.views[Math.min(this.active, this.views.length - 1)];
  }

  get visibleViews(): View[] {
    return this.views.slice(0, this.layout);
  }

  select(at: string): void {
    this.selected = at;
    this.changed();
  }

  /** Opens the search for an operation that goes between a step and some of what takes it. */
  insert(step: string, inFront: string[]): void {
    this.select(`steps/${step}`);
    this.inFront = inFront;
    this.dialog = "add";
  }

  open(tab: Tab): void {
    this.tab = tab;
    this.panelOpen = true;
    this.changed();
  }

  setLayout(count: 1 | 2 | 4): void {
    while (this.views.length < count) {
      const view = this.makeView(this.views.length);
      this.views.push(view);
    }
    this.layout = count;
    this.active = Math.min(this.active, count - 1);
    const camera = this.views[0].camera ?? this.state?.camera;
    const directions = count === 2 ? ["", "1"] : ["7", "1", "3", "5"];
    // The first view stays as it is; the others look along the axes.
    if (camera) for (let i = 1; i < count; i++) if (!this.views[i].camera) this.lookAlong(directions[i], this.views[i]);
    this.changed();
    // The size of a view changes with the layout; its observer asks for the picture.
  }

  lookAlong(key: string, view = this.view, parallel?: boolean): void {
    const base = view.camera ?? this.views[0].camera ?? this.state?.camera;
    const bounds = this.state?.bounds;
    const named = namedViews(upIsY(this.state?.camera ?? null)).find((v) => v.key === key);
    if (!base || !bounds || !named) return;
    const camera = parallel === undefined ? base : { ...base, parallel };
    view.look(fit(camera, bounds, named.direction, named.up, view.aspect), false, false);
  }

  projection(): void {
    if (this.view.camera) this.view.look(toggleProjection(this.view.camera), false);
  }

  reset(): void {
    const camera = this.state?.camera;
    if (camera) this.view.look(camera, false, false);
    else this.lookAlong("7");
  }

  toggleFullScreen(): void {
    if (document.fullscreenElement) void document.exitFullscreen();
    else void document.documentElement.requestFullscreen?.().catch(() => this.say("The browser does not allow full screen here"));
  }

  private makeView(index: number): View {
    return new View(index, {
      connection: this.session.connection,
      tool: () => this.tool,
      moved: (view, before, after) => this.moved(view, before, after),
      asked: () => this.changed(),
      drawn: (view) => {
        this.player.drawn(view);
        if (view.frame?.final) this.session.progress = null;
        this.changed();
      },
      click: (view, at, button) => {
        this.active = view.index;
        if (button !== "left") return;
        if (this.tool === "measure") void this.rulers.click(view, at);
        else void this.probe.click(view, at);
      },
      hover: (view, at) => {
        this.probe.hover(view, at);
        if (at) this.company.pointed(view, at);
      },
      toolDrag: (view, drag, phase) => this.toolDrag(view, drag, phase),
    });
  }

  private moved(view: View, before: Camera, after: Camera): void {
    this.active = view.index;
    this.company.moved(view);
    if (this.layout > 1 && this.link !== "none")
      for (const other of this.visibleViews)
        if (other !== view && other.camera) other.look(follow(other.camera, before, after, this.link), true, false);
    this.changed();
  }

  private toolDrag(view: View, drag: Drag, phase: "begin" | "drag" | "end"): boolean {
    this.active = view.index;
    if (this.tool === "window") return levelDrag(this, view, drag, phase);
    if (this.tool === "line") return this.lines.drag(view, drag, phase);
    if (this.tool === "lasso" || this.tool === "rectangle") return this.selections.drag(view, drag, phase, this.tool);
    return false;
  }

  private stateCame(state: State, before: State | null): void {
    if (!before) {
      this.beginning = state.pipeline;
      // A view that has asked for nothing yet begins with the camera chosen from the data; what it has asked for comes with that camera.
      for (const v of this.views) if (!v.camera && state.camera && v.drawing.newest === 0) v.look(state.camera, false, false);
      document.title = state.title ? `${state.title} – Sightglass` : "Sightglass";
    }
    this.selected = selectionAfter(this.selected, state, before);
    this.histograms.stateCame();
  }
}
