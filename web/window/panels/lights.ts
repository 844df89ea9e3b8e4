// SPDX-License-Identifier: Apache-2.0
// The lights of the picture, one of them with its controls, and what is around.
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { App } from "../app";
import { named, wantsFile, type Entry } from "../catalog";
import { form } from "../controls/form";
import { icon } from "../icons";
import type { Light, State } from "../protocol";
import { title } from "../words";

// How bright, of which colour and from where is asked of every light first.
const begin = ["brightness", "strength", "color", "from", "size", "angle", "elevation", "azimuth", "haze"];

export function lightsPanel(app: App): TemplateResult {
  const s = app.state!;
  const index = app.selected.startsWith("lights/") ? Number(app.selected.slice(7)) : -1;
  const chosen = s.lights[index];
  return html`<section>
      <div class="row"><h2 class="grow">Lights</h2>${addLight(app, s)}</div>
      ${s.lights.length === 0
        ? html`<p class="quiet">None is stated: the usual ones shine, from the upper left of the viewer.</p>`
        : html`<ul class="list">${s.lights.map((l, i) => item(app, l, i, i === index))}</ul>`}
      ${form(app, { at: "picture", entry: app.catalog.picture, only: ["integrator"] })}
      ${app.session.word("picture", "integrator") === undefined
        ? html`<p class="quiet">Without an integrator lights have a direction and a brightness. Their colours and sizes, shadows and what is around take one.</p>`
        : nothing}
    </section>
    ${chosen ? details(app, `lights/${index}`, `Light ${index + 1}: ${chosen.kind}`, named(app.catalog.lights, chosen.kind)) : nothing}
    ${environment(app, s)}`;
}

function item(app: App, light: Light, i: number, chosen: boolean): TemplateResult {
  const at = `lights/${i}`;
  const { from, position, elevation } = light.words;
  const where = position ? `at ${position}` : from ? `from ${from}` : elevation ? `${elevation}° high` : "";
  return html`<li class="item ${chosen ? "chosen" : ""}">
    <button class="grow item-name" aria-pressed=${chosen ? "true" : "false"} @click=${() => app.select(at)}><span>${light.kind}</span><span class="quiet">${where}</span></button>
    <button class="icon small" aria-label="Remove light ${i + 1}, ${light.kind}" title="Remove" ?disabled=${!app.state!.may_edit} @click=${() => app.session.edit([{ remove: at }])}>${icon("close")}</button></li>`;
}

function details(app: App, at: string, name: string, entry: Entry | undefined): TemplateResult {
  const problem = app.session.edits.problem(at, "");
  return html`<section><h2>${name}</h2>
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    ${entry ? html`<p class="quiet">${entry.sentence}</p>${form(app, { at, entry, begin })}` : html`<p class="empty">The catalogue does not know it.</p>`}
  </section>`;
}

function addLight(app: App, s: State): TemplateResult {
  // The lights of a file are there only where one is read that can have them.
  const inFile = s.steps.some((x) => /\.(gltf|glb)$/i.test(x.words.path ?? ""));
  return html`<select class="small" aria-label="Add a light" ?disabled=${!s.may_edit}
    @change=${(e: Event) => {
      const select = e.target as HTMLSelectElement;
      if (select.value) app.session.edit([{ add: "light", kind: select.value, set: {} }]);
      select.value = "";
    }}>
    <option value="">+ light …</option>
    ${app.catalog.lights.filter((k) => k.name !== "file" || inFile).map((k) => html`<option value=${k.name} title=${k.sentence}>${k.name}</option>`)}
  </select>`;
}

/** What is around: as usual, or one of the kinds; a picture of all directions only where the session has one already. */
function environment(app: App, s: State): TemplateResult {
  const now = s.environment?.kind ?? "";
  const kinds = app.catalog.environments.filter((k) => !wantsFile(k) || k.name === now);
  const entry = named(app.catalog.environments, now);
  const problem = app.session.edits.problem("environment", "");
  return html`<section>
    <div class="row"><h2 class="grow">Around</h2>
      <select aria-label="What is around" ?disabled=${!s.may_edit} .value=${live(now)}
        @change=${(e: Event) => {
          const kind = (e.target as HTMLSelectElement).value;
          app.session.edit([kind ? { add: "environment", kind, set: {} } : { remove: "environment" }]);
        }}>
        <option value="" ?selected=${now === ""}>as usual</option>
        ${kinds.map((k) => html`<option value=${k.name} ?selected=${k.name === now}>${title(k.name)}</option>`)}
      </select></div>
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    <p class="quiet">${entry?.sentence ?? "An even light, dim where lights are stated."}</p>
    ${entry ? form(app, { at: "environment", entry, begin }) : nothing}
  </section>`;
}
