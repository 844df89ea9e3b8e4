// SPDX-License-Identifier: Apache-2.0
// Saving the picture: any size, with the recipe that makes it again.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { follow } from "../questions/files";
import { dialog } from "./dialog";
import { fitted, sizeProblem } from "./save_size";

const ui = { width: 1920, height: 1080, type: "png", busy: false, chosen: false };

const sizes: [string, number, number][] = [
  ["1920 × 1080", 1920, 1080],
  ["3840 × 2160 (4K)", 3840, 2160],
  ["2400 × 1800 (print, 4:3)", 2400, 1800],
  ["1200 × 1200", 1200, 1200],
];

export function saveDialog(app: App): TemplateResult {
  const view = app.view;
  const saves = app.state?.saves;
  if (!saves) return html``;
  if (!ui.chosen && view.size.width > 0) {
    // At first the shape that is seen, twice as fine.
    [ui.width, ui.height] = fitted(Math.round(view.size.width * 2), Math.round(view.size.height * 2), saves.most_pixels);
    ui.chosen = true;
  }
  const problem = sizeProblem(ui.width, ui.height, saves.most_pixels);
  const number = (name: "width" | "height"): TemplateResult => html`<label>${name} <input class="number" inputmode="numeric" .value=${String(ui[name])}
    @change=${(e: Event) => { ui[name] = Math.max(16, Math.round(Number((e.target as HTMLInputElement).value)) || ui[name]); app.changed(); }} /></label>`;
  return dialog(app, "Save the picture", html`
    <div class="row wrap">${sizes.map(([label, w, h]) => html`<button class="small" aria-pressed=${ui.width === w && ui.height === h ? "true" : "false"} @click=${() => { ui.width = w; ui.height = h; app.changed(); }}>${label}</button>`)}
      <button class="small" @click=${() => { ui.chosen = false; app.changed(); }}>as seen</button></div>
    <div class="row wrap">${number("width")}${number("height")}
      <label>as <select @change=${(e: Event) => { ui.type = (e.target as HTMLSelectElement).value; }}>${saves.types.map((t) => html`<option ?selected=${t === ui.type}>${t}</option>`)}</select></label></div>
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    <p class="quiet">A PNG carries its recipe: <code>sightglass open picture.png</code>, in a folder above the data, makes it again, byte for byte.</p>
    <div class="row"><button class="primary" ?disabled=${ui.busy || problem !== ""} @click=${() => void save(app)}>${ui.busy ? "Drawing …" : "Save"}</button></div>`);
}

async function save(app: App): Promise<void> {
  ui.busy = true;
  app.changed();
  try {
    const a = await app.session.connection.ask<{ is: "saved"; n: number; url: string; name: string }>(
      { do: "save", size: [ui.width, ui.height], camera: app.view.camera ?? undefined, type: ui.type },
      600,
    );
    follow(a.url, a.name);
    app.dialog = null;
    app.say(`Saved ${a.name}`);
  } catch (error) {
    app.say((error as Error).message);
  }
  ui.busy = false;
  app.changed();
}
