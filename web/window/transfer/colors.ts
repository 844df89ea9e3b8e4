// SPDX-License-Identifier: Apache-2.0
// The colour map of what is shown, its lightness beside it, and the list of maps to choose from.
import { icon } from "../icons";
import { html, nothing, svg, type TemplateResult } from "lit";
import { ref } from "lit/directives/ref.js";
import type { App } from "../app";
import type { Transfer } from "../protocol";
import { plain } from "../words";
import { lightness, mapByName, maps, type ColorMap } from "./maps";

const ui = { open: false, query: "", kind: "" };

/** Draws colours side by side; a canvas, as many small elements would be slow and inline styles are forbidden. */
function paint(canvas: HTMLCanvasElement, colors: string[]): void {
  const key = colors.join("");
  if (canvas.dataset.colors === key) return;
  canvas.dataset.colors = key;
  canvas.width = 256;
  canvas.height = 1;
  const context = canvas.getContext("2d")!;
  const gradient = context.createLinearGradient(0, 0, 256, 0);
  colors.forEach((c, i) => gradient.addColorStop(colors.length > 1 ? i / (colors.length - 1) : 0, c));
  context.fillStyle = gradient;
  context.fillRect(0, 0, 256, 1);
}

/** A strip of colours; of a categorical map with hard edges. */
export function strip(colors: string[], label: string): TemplateResult {
  return html`<canvas class="strip" role="img" aria-label=${label} ${ref((e) => e && paint(e as HTMLCanvasElement, colors))}></canvas>`;
}

export function colors(app: App, index: number, t: Transfer): TemplateResult {
  const at = `show/${index}`;
  const word = app.session.word(at, "map");
  const known = mapByName(word ?? t.map ?? "");
  // Until the server's answer comes, the colours of a map just chosen are those of the table.
  const shown = word !== undefined && word !== t.map && known ? known.colors : t.colors;
  const light = word !== undefined && word !== t.map ? undefined : t.lightness;
  const curve = light && light.length > 1 ? light : shown.map(lightness);
  const falls = countFalls(curve);
  const reversed = (word ?? "").endsWith("_r");
  const choose = (name: string | null, live = false): void => app.session.set(at, { map: name }, live);
  return html`<div class="colors">
    <div class="row">
      <span class="grow"><strong>${word ?? t.map ?? "colours"}</strong> <span class="quiet">${known ? `${known.kind}${falls > 0 ? `, lightness turns ${falls}×` : ""}` : ""}</span></span>
      ${known ? html`<button class="small" aria-pressed=${reversed ? "true" : "false"} @click=${() => choose(reversed ? word!.slice(0, -2) : `${word ?? t.map}_r`)}>reversed</button>` : nothing}
      <button class="small" aria-expanded=${ui.open ? "true" : "false"} @click=${() => { ui.open = !ui.open; app.changed(); }}>Choose …</button>
      ${word !== undefined ? html`<button class="icon small" aria-label="Back to the default map" @click=${() => choose(null)}>${icon("reset")}</button>` : nothing}
    </div>
    ${strip(shown, `Colours from ${plain(t.range[0])} to ${plain(t.range[1])}`)}
    <svg class="lightness" viewBox="0 0 320 44" role="img" aria-label="Lightness of the map from ${Math.round(curve[0] * 100)} to ${Math.round(curve[curve.length - 1] * 100)}, ${falls === 0 ? "in one direction" : `turning ${falls} times`}">
      <line x1="0" x2="320" y1="43" y2="43" /><line x1="0" x2="320" y1="1" y2="1" />
      ${svg`<path d="M${curve.map((l, i) => `${((i / (curve.length - 1)) * 320).toFixed(1)} ${(43 - 42 * l).toFixed(1)}`).join("L")}" />`}
      <text x="4" y="11">L*</text>
    </svg>
    ${ui.open ? list(app, word ?? t.map ?? "", choose) : nothing}
  </div>`;
}

/** How often a lightness curve changes its direction by more than rounding. */
export function countFalls(curve: number[]): number {
  let turns = 0;
  let direction = 0;
  let extreme = curve[0];
  for (const l of curve) {
    if (direction === 0) {
      if (Math.abs(l - extreme) > 0.02) direction = Math.sign(l - extreme);
      if (direction !== 0) extreme = l;
    } else if ((l - extreme) * direction > 0) extreme = l;
    else if (Math.abs(l - extreme) > 0.02) {
      turns++;
      direction = -direction;
      extreme = l;
    }
  }
  return turns;
}

function list(app: App, chosen: string, choose: (name: string) => void): TemplateResult {
  const kinds = [...new Set(maps.map((m) => m.kind))];
  const q = ui.query.toLowerCase();
  const found = maps.filter((m) => (ui.kind === "" || m.kind === ui.kind) && (q === "" || `${m.name} ${m.about}`.toLowerCase().includes(q)));
  const option = (m: ColorMap): TemplateResult => html`<button class="map ${m.name === chosen ? "chosen" : ""}" aria-pressed=${m.name === chosen ? "true" : "false"}
      title=${m.about} @click=${() => choose(m.name)}>${strip(m.colors, "")}<span>${m.name}</span></button>`;
  return html`<div class="map-list">
    <div class="row">
      <input type="search" class="grow" placeholder="Search maps" aria-label="Search colour maps" .value=${ui.query} @input=${(e: Event) => { ui.query = (e.target as HTMLInputElement).value; app.changed(); }} />
      <select aria-label="Kind of colour map" @change=${(e: Event) => { ui.kind = (e.target as HTMLSelectElement).value; app.changed(); }}>
        <option value="">all</option>${kinds.map((k) => html`<option value=${k} ?selected=${ui.kind === k}>${k}</option>`)}
      </select>
    </div>
    <div class="maps" role="group" aria-label="Colour maps">${found.map(option)}</div>
  </div>`;
}
