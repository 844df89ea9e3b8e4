// SPDX-License-Identifier: Apache-2.0
// The tools beside the picture: what a drag does, where from one looks, and how many views there are.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import type { App, Tool } from "../app";
import { namedViews, upIsY } from "../camera/camera";

const tools: [Tool, string, string][] = [["turn", "turn", "Turn"], ["pan", "pan", "Move"], ["zoom", "zoom", "Zoom"], ["window", "window", "Window and level"], ["line", "line", "Plot over a line"], ["measure", "measure", "Measure"], ["rectangle", "rectangle", "Numbers in a rectangle"], ["lasso", "lasso", "Numbers in an outline"]];
const directions: Record<string, string> = { "1": "front", "2": "back", "3": "left", "4": "right", "5": "top", "6": "bottom", "7": "corner" };

export function toolbar(app: App): TemplateResult {
  const parallel = app.view.camera?.parallel ?? false;
  const layouts: [1 | 2 | 4, string, string][] = [[1, "one", "One view"], [2, "two", "Two views"], [4, "four", "Four views"]];
  return html`<div class="toolbar" role="toolbar" aria-label="Tools of the picture" aria-orientation="vertical">
    ${tools.map(([t, sign, name]) => html`<button class="icon" aria-label="Tool: ${name}" title=${name} aria-pressed=${app.tool === t ? "true" : "false"} @click=${() => app.commands.run(`tool-${t}`)}>${icon(sign)}</button>`)}
    <hr />
    <label class="icon select-icon" title="Look from">${icon("cube")}<select aria-label="Look from" .value=${""} @change=${(e: Event) => {
      const select = e.target as HTMLSelectElement;
      if (select.value) app.commands.run(`view-${select.value}`);
      select.value = "";
    }}><option value="">Look from …</option>${namedViews(upIsY(app.state?.camera ?? null)).map((v) => html`<option value=${v.key}>${directions[v.key]} (${v.key})</option>`)}</select></label>
    <button class="icon" aria-label="Parallel projection" title="Perspective or parallel (p)" aria-pressed=${parallel ? "true" : "false"} @click=${() => app.commands.run("projection")}>${icon(parallel ? "parallel" : "perspective")}</button>
    <button class="icon" aria-label="The first view again" title="The first view again (r)" @click=${() => app.commands.run("reset")}>${icon("home")}</button>
    <hr />
    ${layouts.map(([n, sign, name]) => html`<button class="icon" aria-label=${name} title=${name} aria-pressed=${app.layout === n ? "true" : "false"} @click=${() => app.setLayout(n)}>${icon(sign)}</button>`)}
    <button class="icon" aria-label="Three planes" title="Three planes with a crosshair" ?disabled=${!app.state?.may_edit} @click=${() => app.commands.run("three-planes")}>${icon("planes")}</button>
    ${app.layout > 1
      ? html`<label class="icon select-icon" title="Cameras go together: ${app.link}">${icon("link")}<select aria-label="Cameras go together" @change=${(e: Event) => {
          app.link = (e.target as HTMLSelectElement).value as App["link"];
          app.changed();
        }}>
          <option value="none" ?selected=${app.link === "none"}>each its own</option>
          <option value="place" ?selected=${app.link === "place"}>place and zoom together</option>
          <option value="all" ?selected=${app.link === "all"}>turning, too</option></select></label>`
      : nothing}
  </div>`;
}
