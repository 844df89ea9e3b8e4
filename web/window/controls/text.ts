// SPDX-License-Identifier: Apache-2.0
// Words: names, expressions, titles, paths of the server, and names of colour maps.
import { html, nothing, type TemplateResult } from "lit";
import { mapNames } from "../transfer/maps";
import { describedBy, invalid } from "./control";
import type { Context } from "./form";
import { held, typed, typing } from "./held";
import { defaultText, suggestsFields, typesOf } from "./kind";

export function text(c: Context, id: string): TemplateResult {
  const isList = typesOf(c.schema).includes("array");
  const suggestions = suggestsFields(c.name) ? c.fields.map((f) => f.name) : [];
  return html`<input
      id=${id} type="text" autocomplete="off" spellcheck="false" ${held(c.value ?? "")} placeholder=${defaultText(c.schema) || (isList ? "none" : "auto")}
      list=${suggestions.length > 0 ? `${id}-list` : nothing} aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
      @input=${typing} @change=${(e: Event) => c.set(typed(e) || null)} />
    ${suggestions.length > 0 ? html`<datalist id="${id}-list">${suggestions.map((s) => html`<option value=${s}></option>`)}</datalist>` : nothing}`;
}

export function mapChoice(c: Context, id: string): TemplateResult {
  return html`<input id=${id} type="text" autocomplete="off" spellcheck="false" ${held(c.value ?? "")} placeholder="auto" list="${id}-list"
      aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)} @input=${typing} @change=${(e: Event) => c.set(typed(e) || null)} />
    <datalist id="${id}-list">${mapNames.map((n) => html`<option value=${n}></option>`)}</datalist>`;
}
