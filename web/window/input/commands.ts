// SPDX-License-Identifier: Apache-2.0
// The actions behind keys and buttons.
import type { App } from "../app";
import { threePlanes } from "../slices/three_planes";
import { actionOf, isTyping, nameOf } from "./keys";

export class Commands {
  constructor(private readonly app: App) {
    document.addEventListener("keydown", (e) => this.key(e));
  }

  run(action: string): boolean {
    const { app } = this;
    if (action.startsWith("view-")) {
      app.lookAlong(action.slice(5));
      return true;
    }
    if (action.startsWith("tool-")) {
      app.tool = action.slice(5) as App["tool"];
      app.changed();
      return true;
    }
    if (action.startsWith("measure-")) return this.measure(action.slice(8));
    const actions: Record<string, () => void> = {
      projection: () => app.projection(),
      reset: () => app.reset(),
      "full-screen": () => app.toggleFullScreen(),
      panel: () => {
        app.panelOpen = !app.panelOpen;
        app.changed();
      },
      add: () => this.openDialog("add"),
      save: () => this.openDialog("save"),
      help: () => this.openDialog("help"),
      legend: () => this.openDialog("legend"),
      play: () => app.player.toggle(),
      "step-back": () => app.player.step(-1),
      "step-on": () => app.player.step(1),
      undo: () => app.session.undo(),
      redo: () => app.session.redo(),
      "three-planes": () => threePlanes(app),
    };
    const act = actions[action];
    if (act) act();
    else return app.view.act(action);
    return true;
  }

  /** False where there is nothing to do: the key then keeps its usual meaning. */
  private measure(what: string): boolean {
    const { rulers, selections, tool, view } = this.app;
    if (what === "clear" && tool !== "measure") return selections.clearOutline();
    if (tool !== "measure") return false;
    if (what === "middle") void rulers.clickMiddle(view);
    return what === "middle" || (what === "back" ? rulers.back() : rulers.clear());
  }

  private openDialog(which: App["dialog"]): void {
    this.app.dialog = which;
    this.app.inFront = [];
    this.app.changed();
  }

  private key(e: KeyboardEvent): void {
    if (e.defaultPrevented || this.app.dialog !== null) return;
    const name = nameOf(e);
    const focus = document.activeElement;
    if (isTyping(focus, name)) return;
    const action = actionOf(name, focus?.closest(".view-surface") !== null && focus?.closest("[data-handle]") === null);
    if (action && this.run(action)) e.preventDefault();
  }
}
