// SPDX-License-Identifier: Apache-2.0
// Where a node is when, its keys, and its copies: listed one by one, or at the points of a step.
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { App } from "../app";
import { named } from "../catalog";
import { form } from "../controls/form";
import { icon } from "../icons";
import type { SceneNode, State, Words } from "../protocol";
import { plain } from "../words";

const begin = ["time", "translate", "scale", "angle", "axis", "center"];
const ui = { open: "" }; // the place of the entry whose controls are seen

export function nodeEntries(app: App, s: State, n: SceneNode): TemplateResult {
  return html`${keys(app, s, n)}${copies(app, s, n)}`;
}

function keys(app: App, s: State, n: SceneNode): TemplateResult {
  const add = (): void => {
    const set = nextKey(n.key_words);
    ui.open = `keys/${n.key_words.length}/${n.name}`;
    app.session.edit([{ add: "key", to: n.name, set }]);
  };
  return html`<div class="row"><h3 class="grow">Keys</h3><button class="small" ?disabled=${!s.may_edit} aria-label="Add a key to ${n.name}" @click=${add}>+ key</button></div>
    ${n.keys === 0 ? html`<p class="quiet">At rest. Two keys at different times let it move from one place to the other.</p>` : nothing}
    ${list(app, s, n.key_words, (i) => `keys/${i}/${n.name}`, "key", (w) => `time ${plain(Number(w.time ?? 0))}`, n.keys)}`;
}

function copies(app: App, s: State, n: SceneNode): TemplateResult {
  const add = (): void => {
    ui.open = `copies/${n.copy_words.length}/${n.name}`;
    app.session.edit([{ add: "copy", to: n.name, set: n.copy_words[n.copy_words.length - 1] ?? {} }]);
  };
  const at = `points/${n.name}`;
  const place = (of: string): void => app.session.edit([of === "" ? { remove: at } : { add: "points", to: n.name, of, set: n.points_words }]);
  const entry = named(app.catalog.nodes, "point_instances");
  return html`<div class="row"><h3 class="grow">Copies</h3>
      <select class="small" aria-label="Copies of ${n.name} at the points of" ?disabled=${!s.may_edit} .value=${live(n.copies_of)} @change=${(e: Event) => place((e.target as HTMLSelectElement).value)}>
        <option value="" ?selected=${n.copies_of === ""}>${n.copies_of === "" ? "at points of …" : "not at points"}</option>
        ${s.steps.map((x) => html`<option value=${x.name} ?selected=${x.name === n.copies_of}>at points of ${x.name}</option>`)}
      </select>
      <button class="small" ?disabled=${!s.may_edit} aria-label="Add a copy to ${n.name}" @click=${add}>+ copy</button></div>
    ${n.copies === 0 && n.copies_of === "" ? html`<p class="quiet">It stands once, in its own place. With copies it stands in each of theirs instead.</p>` : nothing}
    ${n.copies_of && entry ? html`${problem(app, at)}${form(app, { at, entry, step: n.copies_of })}` : nothing}
    ${list(app, s, n.copy_words, (i) => `copies/${i}/${n.name}`, "copy", (_, i) => `copy ${i + 1}`, n.copies)}`;
}

/** Entries, one of them opened. */
function list(app: App, s: State, entries: Words[], place: (i: number) => string, kind: "key" | "copy", name: (w: Words, i: number) => string, count: number): TemplateResult | typeof nothing {
  const entry = named(app.catalog.nodes, kind === "key" ? "key" : "instance");
  if (entries.length === 0) return nothing;
  const item = (w: Words, i: number): TemplateResult => {
    const at = place(i);
    const open = ui.open === at;
    const toggle = (): void => {
      ui.open = open ? "" : at;
      app.changed();
    };
    return html`<li>
      <div class="item ${open ? "chosen" : ""}">
        <button class="grow item-name" aria-expanded=${open ? "true" : "false"} @click=${toggle}><span>${name(w, i)}</span><span class="quiet">${toldOf(w)}</span></button>
        <button class="icon small" aria-label="Remove ${name(w, i)}" ?disabled=${!s.may_edit} @click=${() => app.session.edit([{ remove: at }])}>${icon("close")}</button>
      </div>
      ${open && entry ? html`${problem(app, at)}${form(app, { at, entry, begin })}` : nothing}</li>`;
  };
  return html`<ul class="list">${entries.map(item)}</ul>
    ${count > entries.length ? html`<p class="quiet">${count - entries.length} more are in the file.</p>` : nothing}`;
}

function problem(app: App, at: string): TemplateResult | typeof nothing {
  const text = app.session.edits.problem(at, "");
  return text ? html`<p class="problem" role="alert">${text}</p>` : nothing;
}

/** The words but for the time, as "angle 90, translate 1,0,0". */
export const toldOf = (w: Words): string =>
  Object.entries(w)
    .filter(([k]) => k !== "time")
    .map(([k, v]) => `${k} ${v}`)
    .join(", ");

/** A key after the last one, by as much as that is after the one before it, in the same place. */
export function nextKey(keys: Words[]): Words {
  const time = (i: number): number => Number(keys[i]?.time ?? 0);
  const last = keys.length - 1;
  if (last < 0) return { time: "0" };
  const step = last > 0 ? time(last) - time(last - 1) : 1;
  const next = Number((time(last) + (step > 0 ? step : 1)).toPrecision(6));
  return { ...keys[last], time: Number.isFinite(next) ? String(next) : "1" };
}
