// SPDX-License-Identifier: Apache-2.0
// The window's frame: bar, views, panel with its tabs, timeline and status line.
import { icon } from "./icons";
import iconUrl from "./icon.svg?url";
import { html, nothing, render, type TemplateResult } from "lit";
import type { App, Tab, Tool } from "./app";
import { noCatalog } from "./catalog";
import { addDialog } from "./panels/add";
import { filePanel } from "./panels/file";
import { helpDialog } from "./panels/help";
import { legendDialog } from "./panels/legend";
import { lookPanel } from "./panels/look";
import { numbersPanel } from "./panels/numbers";
import { plotPanel } from "./panels/plot";
import { saveDialog } from "./panels/save";
import { scenePanel } from "./panels/scene";
import { stepsPanel } from "./panels/steps";
import { tablePanel } from "./panels/table";
import { timeline } from "./panels/timeline";
import { toolbar } from "./panels/toolbar";
import type { FrameHeader } from "./protocol";
import { probeText } from "./questions/probe";
import { themeButton } from "./theme";
import { colorPanel } from "./transfer/panel";
import { overlay } from "./view/overlay";
import { plain } from "./words";

const tabs: [Tab, string][] = [["steps", "Pipeline"], ["look", "Look"], ["scene", "Scene"], ["color", "Colour"], ["table", "Table"], ["plot", "Plot"], ["numbers", "Numbers"], ["file", "Session"]];

export function draw(app: App, root: HTMLElement): void {
  render(shell(app), root);
  for (const v of app.visibleViews) render(overlay(app, v), v.overlay);
}

function shell(app: App): TemplateResult {
  const s = app.state;
  return html`<div class="window ${app.panelOpen ? "with-panel" : ""}">
    <header class="bar">
      <h1 title=${s?.title ?? ""}><img src=${iconUrl} alt="" width="20" height="20" /><span>${s?.title || "Sightglass"}</span></h1>
      ${new URLSearchParams(location.search).has("open") ? html`<a class="button small" href="/?below=">Files</a>` : nothing}
      <span class="grow"></span>
      ${bar("undo", "undo", "Undo", !s?.can_undo)}${bar("redo", "redo", "Redo", !s?.can_redo)}
      ${bar("add", "add", "Add an operation", !s?.may_edit)}${bar("save", "save", "Save the picture")}
      ${themeButton(app)}${bar("full-screen", "full", "Full screen")}${bar("help", "help", "Help")}
      <button class="icon" aria-label="Panel" title="Panel" aria-expanded=${app.panelOpen ? "true" : "false"} @click=${() => app.commands.run("panel")}>${icon("panel")}</button>
    </header>
    <main class="stage">
      ${toolbar(app)}
      <div class="views n${app.layout}">
        ${app.visibleViews.map((v) => html`<div class="view ${v.index === app.active && app.layout > 1 ? "active" : ""}">${v.element}${badge(app, v.index)}</div>`)}
      </div>
      ${timeline(app)}
      ${status(app)}
    </main>
    ${app.panelOpen ? panel(app) : nothing}
    ${app.session.connected === "lost" ? html`<div class="banner" role="alert">The connection was lost; trying again … If the server was ended, start it again and open the address that it prints.</div>` : nothing}
    <div class="toast ${app.message ? "on" : ""}" role="status" aria-live="polite">${app.message}</div>
    ${app.dialog === "help" ? helpDialog(app) : app.dialog === "add" ? addDialog(app) : app.dialog === "save" ? saveDialog(app) : app.dialog === "legend" ? legendDialog(app) : nothing}
  </div>`;

  function bar(action: string, sign: string, name: string, disabled = false): TemplateResult {
    return html`<button class="icon" aria-label=${name} title=${name} ?disabled=${disabled} @click=${() => app.commands.run(action)}>${icon(sign)}</button>`;
  }
}

/** Whether the picture of a view is the last word, or what is still to come. */
function badge(app: App, index: number): TemplateResult {
  const v = app.views[index];
  const settled = v.drawing.settled(app.state?.revision ?? 0) && !app.session.isChanging;
  v.element.setAttribute("aria-label", `Picture of ${app.state?.title ?? "the data"}${app.layout > 1 ? `, view ${index + 1}` : ""}: arrow keys turn it, with shift they move it, + and - zoom, ? lists all keys`);
  return html`<span class="refining ${settled ? "" : "on"}" aria-hidden="true"></span>`;
}

function panel(app: App): TemplateResult {
  const content: Record<Tab, () => TemplateResult> = {
    steps: () => stepsPanel(app),
    look: () => lookPanel(app),
    scene: () => scenePanel(app),
    color: () => colorPanel(app),
    table: () => tablePanel(app),
    plot: () => plotPanel(app),
    numbers: () => numbersPanel(app),
    file: () => filePanel(app),
  };
  const move = (e: KeyboardEvent): void => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
    if (!by) return;
    e.preventDefault();
    const i = (tabs.findIndex(([t]) => t === app.tab) + by + tabs.length) % tabs.length;
    app.open(tabs[i][0]);
    requestAnimationFrame(() => document.getElementById(`tab-${tabs[i][0]}`)?.focus());
  };
  return html`<aside class="panel" aria-label="Controls">
    <div class="tabs" role="tablist" aria-label="Panels" @keydown=${move}>
      ${tabs.map(([t, name]) => html`<button role="tab" id="tab-${t}" aria-selected=${t === app.tab ? "true" : "false"} aria-controls="panel-body" tabindex=${t === app.tab ? 0 : -1} @click=${() => app.open(t)}>${name}</button>`)}
    </div>
    <div class="panel-body" id="panel-body" role="tabpanel" aria-labelledby="tab-${app.tab}" tabindex="-1">
      ${app.state && !app.state.may_edit ? html`<p class="quiet pad">This session can be looked at, not changed.</p>` : nothing}
      ${app.state && app.catalog !== noCatalog ? content[app.tab]() : html`<p class="empty">Reading …</p>`}
    </div>
  </aside>`;
}

function status(app: App): TemplateResult {
  const { probe, session } = app;
  const here = probe.current?.answer ?? probe.pinned?.answer;
  const f = app.view.frame;
  const p = session.progress;
  return html`<footer class="status">
    <span class="grow probe">${here ? probeText(here, app.state?.length_unit) : html`<span class="quiet">${toolHint(app.tool)}</span>`}</span>
    ${p ? html`<span class="progress"><progress max="1" .value=${p.share} aria-label="Progress"></progress> ${p.doing}</span>` : nothing}
    ${session.people.count > 1 ? people(app) : nothing}
    ${f ? html`<span class="quiet facts-line" title=${factsText(app, f)}>${factsText(app, f)}</span>` : nothing}
  </footer>`;
}

/** What the frame is, and how far it has come. */
function factsText(app: App, f: FrameHeader): string {
  const facts = [`${f.of[0]}×${f.of[1]}`, `${Math.round(f.milliseconds)} ms`];
  if (app.view.camera?.parallel) facts.push("parallel");
  if (f.told) facts.push(f.told);
  if (!f.final) facts.push(f.coarse > 1 ? `${plain(f.coarse)}× coarser` : "refining");
  return facts.join(" · ");
}

function people(app: App): TemplateResult {
  const { people } = app.session;
  const others = people.cursors.filter((c) => c.camera);
  return html`<span class="people">${people.count} people
    <label class="row"><input type="checkbox" .checked=${people.together} @change=${(e: Event) => app.company.setTogether((e.target as HTMLInputElement).checked)} />one view for all</label>
    ${!people.together && others.length > 0
      ? html`<select class="small" aria-label="Look along with" @change=${(e: Event) => app.company.follow(Number((e.target as HTMLSelectElement).value) || null)}>
          <option value="" ?selected=${app.company.following === null}>own view</option>
          ${others.map((c) => html`<option value=${c.id} ?selected=${c.id === app.company.following}>with ${c.id}</option>`)}</select>`
      : nothing}</span>`;
}

const toolHint = (tool: Tool): string =>
  ({
    turn: "Drag to turn; click to keep a value",
    pan: "Drag to move",
    zoom: "Drag up or down to zoom",
    window: "Drag across for the window, up and down for the level",
    line: "Drag from one end of the line to the other",
    measure: "Click places: two have a distance, three an angle, more an area; drag to turn",
    rectangle: "Drag a rectangle to see the numbers in it",
    lasso: "Draw around what is to be measured",
  })[tool];
