// SPDX-License-Identifier: Apache-2.0
// One parameter: its label, unit, control, help in place, the way back to its default, and what the server objects to.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import { title } from "../words";
import type { Context } from "./form";
import { choice, choices, toggle } from "./choice";
import { color } from "./color";
import { field, fields } from "./field";
import { isColor, kindOf } from "./kind";
import { ends, list, vector } from "./list";
import { number } from "./number";
import { mapChoice, text } from "./text";

const helped = new Set<string>();

export function idOf(c: Context): string {
  return `${c.at}-${c.name}`.replace(/[^\w-]/g, "-");
}

const unitOf = (c: Context): string => {
  const u = c.schema.unit;
  if (!u || u === c.name || u === "file" || u === "new file" || isColor(c.schema)) return "";
  if (u === "@field") return fieldOf(c)?.unit ?? "";
  if (u === "length" || u === "world length") return c.app.state?.length_unit ?? "";
  return u === "deg" ? "°" : u.startsWith("@") ? "" : u;
};

/** The field that the words of this form name, or else the first one, whose range a value then has. */
export function fieldOf(c: Context): Context["fields"][number] | undefined {
  const name = c.app.session.word(c.at, "field") ?? c.app.session.wordsAt(c.at).field;
  return c.fields.find((f) => f.name === name) ?? c.fields[0];
}

export function control(c: Context): TemplateResult {
  const id = idOf(c);
  const problem = c.app.session.edits.problem(c.at, c.name);
  const open = helped.has(id);
  const unit = unitOf(c);
  const help = c.schema.description ?? "";
  const short = /^(.{0,90}?[^.\d])\.(\s|$)/.exec(help)?.[1] ?? help.slice(0, 90);
  return html`<div class="control ${problem ? "bad" : ""} ${c.value !== undefined ? "set" : ""}" data-word=${c.name}>
    <div class="control-head">
      <label for=${id} title=${short}>${title(c.name)}${unit ? html`<span class="unit"> ${unit}</span>` : nothing}</label>
      ${c.value !== undefined
        ? html`<button class="icon small" title="Back to the default" aria-label="Back to the default: ${c.name}" @click=${() => c.set(null)}>${icon("reset")}</button>`
        : nothing}
      <button
        class="icon small help-button" aria-label="Help: ${c.name}" aria-expanded=${open ? "true" : "false"} title=${short}
        @click=${() => {
          if (open) helped.delete(id);
          else helped.add(id);
          c.app.changed();
        }}>?</button>
    </div>
    <div class="control-body">${body(c, id)}</div>
    ${open ? html`<p class="help" id="${id}-help">${help}</p>` : nothing}
    ${problem ? html`<p class="problem" id="${id}-problem" role="alert">${problem}</p>` : nothing}
  </div>`;
}

function body(c: Context, id: string): TemplateResult {
  switch (kindOf(c.name, c.schema)) {
    case "switch":
      return toggle(c, id);
    case "number":
      return number(c, id);
    case "choice":
      return choice(c, id);
    case "choices":
      return choices(c, id);
    case "field":
      return field(c, id);
    case "fields":
      return fields(c, id);
    case "color":
      return color(c, id);
    case "map":
      return mapChoice(c, id);
    case "vector":
      return vector(c, id);
    case "ends":
      return ends(c, id);
    case "numbers":
      return list(c, id);
    default:
      return text(c, id);
  }
}

/** What describes an input to those who listen: the objection, if there is one. */
export const describedBy = (c: Context, id: string): string | typeof nothing =>
  c.app.session.edits.problem(c.at, c.name) ? `${id}-problem` : nothing;

export const invalid = (c: Context): "true" | "false" => (c.app.session.edits.problem(c.at, c.name) ? "true" : "false");
