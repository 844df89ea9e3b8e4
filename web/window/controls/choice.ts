// SPDX-License-Identifier: Apache-2.0
// One of several words, some of several words, and yes or no.
import { html, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { describedBy, invalid } from "./control";
import type { Context } from "./form";
import { choicesOf, defaultText, typesOf } from "./kind";

export function choice(c: Context, id: string): TemplateResult {
  const options = choicesOf(c.schema);
  const fallback = defaultText(c.schema);
  return html`<select id=${id} aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)} .value=${live(c.value ?? "")}
    @change=${(e: Event) => c.set((e.target as HTMLSelectElement).value || null)}>
    <option value="" ?selected=${c.value === undefined}>${fallback === "" ? "auto" : `${fallback} (default)`}</option>
    ${options.map((o) => html`<option value=${o} ?selected=${c.value === o}>${o.replaceAll("_", " ")}</option>`)}
  </select>`;
}

export function choices(c: Context, id: string): TemplateResult {
  const chosen = (c.value ?? defaultText(c.schema)).split(",").filter(Boolean);
  return html`<div class="choices" id=${id} role="group" aria-label=${c.name}>
    ${choicesOf(c.schema).map(
      (o) => html`<label><input type="checkbox" .checked=${live(chosen.includes(o))}
        @change=${(e: Event) => {
          const on = (e.target as HTMLInputElement).checked;
          c.set((on ? [...chosen, o] : chosen.filter((x) => x !== o)).join(",") || null);
        }} /> ${o.replaceAll("_", " ")}</label>`,
    )}
  </div>`;
}

export function toggle(c: Context, id: string): TemplateResult {
  const open = typesOf(c.schema).includes("null");
  if (open)
    return html`<select id=${id} .value=${live(c.value ?? "")} @change=${(e: Event) => c.set((e.target as HTMLSelectElement).value || null)}>
      <option value="" ?selected=${c.value === undefined}>auto</option>
      <option value="true" ?selected=${c.value === "true"}>yes</option>
      <option value="false" ?selected=${c.value === "false"}>no</option>
    </select>`;
  const on = (c.value ?? String(c.schema.default ?? false)) === "true";
  return html`<input id=${id} type="checkbox" class="switch" .checked=${live(on)}
    @change=${(e: Event) => c.set(String((e.target as HTMLInputElement).checked))} />`;
}
