// SPDX-License-Identifier: Apache-2.0
// The tab of what is shown: each way to show with its controls, and the words of the picture.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { App } from "../app";
import { showEntry } from "../catalog";
import { form } from "../controls/form";
import { legendWords } from "./legend";

export function lookPanel(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  const index = app.selected.startsWith("show/") ? Number(app.selected.slice(5)) : -1;
  const shown = s.show[index];
  const entry = shown ? showEntry(app.catalog, shown.kind) : undefined;
  return html`
    <section>
      <div class="row"><h2 class="grow">Shown</h2>${addShow(app)}</div>
      <ul class="list">
        ${s.show.map((x, i) => html`<li class="item ${i === index ? "chosen" : ""}">
          <button class="grow item-name" aria-pressed=${i === index ? "true" : "false"} @click=${() => app.select(`show/${i}`)}><span>${x.kind}</span><span class="quiet">of ${x.of}${x.in ? ` in ${x.in}` : ""}</span></button>
          <button class="icon small" aria-label="Remove ${x.kind} of ${x.of}" ?disabled=${!s.may_edit} @click=${() => app.session.edit([{ remove: `show/${i}` }])}>${icon("close")}</button></li>`)}
        <li class="item ${app.selected === "picture" ? "chosen" : ""}"><button class="grow item-name" aria-pressed=${app.selected === "picture" ? "true" : "false"} @click=${() => app.select("picture")}><span>picture</span><span class="quiet">title, background, axes</span></button></li>
      </ul>
    </section>
    ${shown && entry
      ? html`<section>
          <div class="row"><h2 class="grow">${shown.kind} of</h2>
            <select aria-label="Step that is shown" ?disabled=${!s.may_edit} .value=${live(shown.of)} @change=${(e: Event) => app.session.edit([{ at: `show/${index}`, of: (e.target as HTMLSelectElement).value }])}>
              ${s.steps.map((x) => html`<option value=${x.name} ?selected=${x.name === shown.of}>${x.name}</option>`)}
            </select>
            <select aria-label="Way to show ${shown.of}" @change=${(e: Event) => changeKind(app, index, (e.target as HTMLSelectElement).value)}>
              ${app.catalog.show.map((k) => html`<option value=${k.name} ?selected=${k.name === shown.kind}>as ${k.name}</option>`)}
            </select></div>
          ${app.session.edits.problem(`show/${index}`, "") ? html`<p class="problem" role="alert">${app.session.edits.problem(`show/${index}`, "")}</p>` : nothing}
          <p class="quiet">${entry.sentence}</p>
          ${shown.transfer ? html`<div class="row"><button class="small" @click=${() => app.open("color")}>Colours and opacity …</button><button class="small" @click=${() => app.commands.run("legend")}>Legend …</button></div>` : nothing}
          ${form(app, { at: `show/${index}`, entry, step: shown.of, without: legendWords.filter((w) => w !== "legend") })}
        </section>`
      : nothing}
    ${app.selected === "picture" ? html`<section><div class="row"><h2 class="grow">Picture</h2><button class="small" @click=${() => app.open("scene")}>Lights …</button></div>${form(app, { at: "picture", entry: app.catalog.picture, step: s.steps[0]?.name, without: ["size", "layout", "views", "samples", "adaptive", "measurements", "lights", "environment"] })}</section>` : nothing}`;
}

/** Another way to show the same: the words that both know are kept. */
function changeKind(app: App, index: number, kind: string): void {
  const old = app.session.shown(index);
  const entry = showEntry(app.catalog, kind);
  if (!old || !entry) return;
  const set = Object.fromEntries(Object.entries(old.words).filter(([w]) => w in entry.params.properties && w !== "opacity" && w !== "style"));
  app.session.edit([{ remove: `show/${index}` }, { add: "show", kind, of: old.of, ...(old.in ? { in: old.in } : {}), set }]);
}

function addShow(app: App): TemplateResult {
  const s = app.state!;
  const last = s.steps[s.steps.length - 1];
  const of = app.selected.startsWith("steps/") ? app.selected.slice(6) : app.selected.startsWith("show/") ? (s.show[Number(app.selected.slice(5))]?.of ?? last?.name) : last?.name;
  return html`<select class="small" aria-label="Add a way to show ${of}" ?disabled=${!s.may_edit || !of}
    @change=${(e: Event) => {
      const select = e.target as HTMLSelectElement;
      if (select.value) app.session.edit([{ add: "show", kind: select.value, of, set: {} }]);
      select.value = "";
    }}>
    <option value="">+ show ${of} as …</option>
    ${app.catalog.show.map((k) => html`<option value=${k.name}>${k.name}</option>`)}
  </select>`;
}
