// SPDX-License-Identifier: Apache-2.0
// Adding a step: a search over names and sentences of all operations and sources.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { search, takesKind, type Entry } from "../catalog";
import type { Step } from "../protocol";
import { suiting } from "../controls/field";
import { takersOf } from "../session/wiring";
import { dialog } from "./dialog";

const ui = { query: "", all: false, at: 0, second: "" };

export function addDialog(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  const input = inputOf(app);
  const entries = [...app.catalog.operations, ...app.catalog.sources];
  const found = search(entries, ui.query).filter((e) => ui.all || e.kind === "source" || takesKind(e, input?.kind));
  ui.at = Math.max(0, Math.min(ui.at, found.length - 1));
  const takers = input ? takersOf(s, input.name) : [];
  const before = takers.map((t) => t.place).filter((p) => app.inFront.includes(p));
  const add = (e: Entry): void => {
    const wants = e.inputs?.[0] ?? 1;
    if (e.kind === "source" && before.length > 0) return app.say(`'${e.name}' takes no step, so that it cannot stand between two`);
    const from = e.kind === "source" ? [] : [input?.name ?? "", ...(ui.second && (e.inputs?.[1] ?? 1) !== 1 ? [ui.second] : [])].filter(Boolean);
    if (from.length < wants) return app.say(`'${e.name}' takes ${wants} steps: choose the second one above the list`);
    // Between others it is seen by what it goes on to.
    const place = before.length > 0 ? { before, show: false } : {};
    app.session.edit([{ add: "step", operation: e.name, from, set: seenField(app, e, input), ...place }]);
    app.dialog = null;
    ui.query = "";
    ui.second = "";
    app.open("steps");
  };
  const key = (e: KeyboardEvent): void => {
    if (e.key === "ArrowDown") ui.at++;
    else if (e.key === "ArrowUp") ui.at = Math.max(0, ui.at - 1);
    else if (e.key === "Enter" && found[ui.at]) add(found[ui.at]);
    else return;
    e.preventDefault();
    app.changed();
  };
  return dialog(
    app,
    before.length > 0 ? "Insert an operation" : "Add an operation",
    html`<div class="row">
        <input class="grow" type="search" autofocus placeholder="contour, slice, streamlines, smooth …" aria-label="Search operations" role="combobox" aria-expanded="true"
          aria-controls="add-list" aria-activedescendant=${found[ui.at] ? `add-${found[ui.at].name}` : nothing}
          .value=${ui.query} @keydown=${key} @input=${(e: Event) => { ui.query = (e.target as HTMLInputElement).value; ui.at = 0; app.changed(); }} />
      </div>
      <div class="row wrap">
        <label>to <select @change=${(e: Event) => app.select(`steps/${(e.target as HTMLSelectElement).value}`)}>${s.steps.map((x) => html`<option ?selected=${x === input}>${x.name}</option>`)}</select></label>
        <label>and <select @change=${(e: Event) => { ui.second = (e.target as HTMLSelectElement).value; app.changed(); }}>
          <option value="">nothing else</option>${s.steps.filter((x) => x !== input).map((x) => html`<option ?selected=${x.name === ui.second}>${x.name}</option>`)}</select></label>
        <label><input type="checkbox" .checked=${ui.all} @change=${(e: Event) => { ui.all = (e.target as HTMLInputElement).checked; app.changed(); }} /> also what does not take ${input?.kind ?? "this"}</label>
      </div>
      ${takers.length > 0 ? html`<div class="row wrap" role="group" aria-label="In front of">
        <span>in front of</span>${takers.map((t) => html`<label><input type="checkbox" .checked=${before.includes(t.place)} @change=${(e: Event) => {
          app.inFront = (e.target as HTMLInputElement).checked ? [...before, t.place] : before.filter((p) => p !== t.place);
          app.changed();
        }} /> ${t.name}</label>`)}</div>` : nothing}
      <ul class="add-list" id="add-list" role="listbox" aria-label="Operations">
        ${found.map((e, i) => html`<li id="add-${e.name}" role="option" aria-selected=${i === ui.at ? "true" : "false"} class=${i === ui.at ? "chosen" : ""} @click=${() => add(e)}>
          <span class="name">${e.name.replaceAll("_", " ")}</span><span class="quiet">${e.family ?? e.kind}</span><span class="sentence">${e.sentence}</span></li>`)}
      </ul>
      ${found.length === 0 ? html`<p class="empty">Nothing found${ui.all ? "" : " that takes this kind of data"}.</p>` : nothing}`,
    true,
  );
}

/** The field that is seen of a step, where the operation takes it: what one looks at is what one means. */
function seenField(app: App, e: Entry, input: Step | undefined): Record<string, string> {
  const wants = e.params.properties.field?.field;
  const seen = app.state!.show.find((s) => s.of === input?.name && s.transfer)?.transfer?.field;
  return wants && suiting(input?.fields ?? [], wants).some((f) => f.name === seen) ? { field: seen! } : {};
}

/** The step that is selected, or that what is selected shows. */
export function inputOf(app: App): Step | undefined {
  const s = app.state!;
  const name = app.selected.startsWith("steps/") ? app.selected.slice(6) : app.selected.startsWith("show/") ? s.show[Number(app.selected.slice(5))]?.of : undefined;
  return s.steps.find((x) => x.name === name) ?? s.steps[s.steps.length - 1];
}
