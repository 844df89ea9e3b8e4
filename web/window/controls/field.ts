// SPDX-License-Identifier: Apache-2.0
// Fields of the data: those that the parameter takes, each with its range and histogram.
import { html, nothing, svg, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { FieldInfo, Histogram } from "../protocol";
import { plain } from "../words";
import { describedBy, invalid } from "./control";
import type { Context } from "./form";

/** What kind of numbers a field holds, in the words of the schema. */
export const kindOfField = (f: FieldInfo): string =>
  f.components === 1 ? "scalar" : f.components === 2 || f.components === 3 ? "vector" : f.components === 6 || f.components === 9 ? "tensor" : "other";

/** The fields that a parameter takes. */
export const suiting = (fields: FieldInfo[], wants: { on: string[]; of: string[] } | undefined): FieldInfo[] =>
  wants ? fields.filter((f) => (wants.on.length === 0 || wants.on.includes(f.on)) && (wants.of.length === 0 || wants.of.includes(kindOfField(f)))) : fields;

export function field(c: Context, id: string): TemplateResult {
  const options = suiting(c.fields, c.schema.field);
  const none = /'none'/.test(c.schema.description ?? "");
  const known = c.value === undefined || c.value === "none" || options.some((f) => f.name === c.value);
  const chosen = options.find((f) => f.name === c.value) ?? null;
  return html`<select id=${id} aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)} .value=${live(c.value ?? "")}
      @change=${(e: Event) => c.set((e.target as HTMLSelectElement).value || null)}>
      <option value="" ?selected=${c.value === undefined}>auto</option>
      ${none ? html`<option value="none" ?selected=${c.value === "none"}>none</option>` : nothing}
      ${options.map((f) => html`<option value=${f.name} ?selected=${f.name === c.value}>${f.name} (${f.on}${f.components > 1 ? `, ${f.components}` : ""})</option>`)}
      ${known ? nothing : html`<option value=${c.value!} selected>${c.value}</option>`}
    </select>
    ${chosen ? fieldLine(c, chosen) : nothing}`;
}

function fieldLine(c: Context, f: FieldInfo): TemplateResult {
  const h = f.components === 1 ? c.app.histograms.of(c.step, f.name) : null;
  return html`<span class="field-line">${h ? sparkline(h) : nothing}
    ${f.range ? html`<span class="quiet">${plain(f.range[0])} … ${plain(f.range[1])} ${f.unit ?? ""}</span>` : nothing}</span>`;
}

/** A histogram in a line of text, by the logarithm of its counts. */
export function sparkline(h: Histogram): TemplateResult {
  const bars = 48;
  const sums = new Array<number>(bars).fill(0);
  h.counts.forEach((n, i) => (sums[Math.floor((i * bars) / h.counts.length)] += n));
  const top = Math.log1p(Math.max(...sums, 1));
  const path = sums.map((n, i) => `L${i} ${(14 * (1 - Math.log1p(n) / top)).toFixed(1)}H${i + 1}`).join("");
  return html`<svg class="sparkline" viewBox="0 0 48 14" preserveAspectRatio="none" aria-hidden="true">${svg`<path d="M0 14${path}V14Z" />`}</svg>`;
}

export function fields(c: Context, id: string): TemplateResult {
  const chosen = (c.value ?? "").split(",").filter(Boolean);
  if (c.fields.length === 0)
    return html`<input id=${id} type="text" .value=${live(c.value ?? "")} placeholder="all" @change=${(e: Event) => c.set((e.target as HTMLInputElement).value || null)} />`;
  return html`<div class="choices" id=${id} role="group" aria-label=${c.name}>
    ${c.fields.map(
      (f) => html`<label><input type="checkbox" .checked=${live(chosen.includes(f.name))}
        @change=${(e: Event) => {
          const on = (e.target as HTMLInputElement).checked;
          c.set((on ? [...chosen, f.name] : chosen.filter((x) => x !== f.name)).join(",") || null);
        }} /> ${f.name}</label>`,
    )}
  </div>`;
}
