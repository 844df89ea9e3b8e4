// SPDX-License-Identifier: Apache-2.0
// The controls of a step, of a way to show or of the picture, made from its schema. Words that were set and those used most come first,
// the rest is one click away.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import type { Entry, Schema } from "../catalog";
import type { FieldInfo } from "../protocol";
import { control } from "./control";

export interface FormOptions {
  at: string;
  entry: Entry;
  step?: string; // whose fields are offered
  only?: string[];
  without?: string[];
  begin?: string[]; // words that come first
}

/** What a control needs to know. */
export interface Context {
  app: App;
  at: string;
  name: string;
  schema: Schema;
  value: string | undefined;
  fields: FieldInfo[];
  step: string;
  set: (value: string | null, live?: boolean) => void;
}

const opened = new Set<string>();

/** How many words stand open at first, and which of the scale's are never among them: few pictures need those. */
const first = 9;
const rare = new Set(["component", "linear_threshold", "below", "above", "nan", "clamp", "legend", "transfer", "save", "feature_angle", "flat"]);

export function form(app: App, o: FormOptions): TemplateResult {
  const all = Object.entries(o.entry.params.properties)
    .filter(([name]) => (!o.only || o.only.includes(name)) && !o.without?.includes(name))
    .sort(([a], [b]) => place(o, a) - place(o, b));
  const isSet = (name: string): boolean => app.session.word(o.at, name) !== undefined || app.session.edits.problem(o.at, name) !== undefined;
  const common = all.filter(([name]) => !rare.has(name)).slice(0, first);
  const main = o.only ? all : all.filter((x) => common.includes(x) || isSet(x[0]));
  const rest = all.filter((x) => !main.includes(x));
  const key = `${o.at} ${o.entry.name}`;
  const show = ([name, schema]: [string, Schema]): TemplateResult => control(contextOf(app, o, name, schema));
  return html`<div class="form">
    ${main.map(show)}
    ${rest.length > 0
      ? html`<details
          class="more" ?open=${opened.has(key)}
          @toggle=${(e: Event) => {
            const open = (e.target as HTMLDetailsElement).open;
            if (open === opened.has(key)) return;
            if (open) opened.add(key);
            else opened.delete(key);
            app.changed();
          }}>
          <summary>${rest.length} more</summary>
          ${opened.has(key) ? rest.map(show) : nothing}
        </details>`
      : nothing}
  </div>`;
}

const place = (o: FormOptions, name: string): number => {
  const at = o.begin?.indexOf(name) ?? -1;
  return at < 0 ? (o.begin?.length ?? 0) : at;
};

function contextOf(app: App, o: FormOptions, name: string, schema: Schema): Context {
  const step = o.step ?? "";
  return {
    app,
    at: o.at,
    name,
    schema,
    value: app.session.word(o.at, name),
    fields: app.session.step(step)?.fields ?? [],
    step,
    set: (value, live = false) => app.session.set(o.at, { [name]: value }, live),
  };
}
