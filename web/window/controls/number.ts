// SPDX-License-Identifier: Apache-2.0
// A number: a box, and a slider where its range has two ends that are near enough.
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { dataBounds } from "../camera/projection";
import { plain, short } from "../words";
import { describedBy, fieldOf, invalid } from "./control";
import type { Context } from "./form";
import { held, typed, typing } from "./held";
import { defaultText, factorRange, sliderRange, typesOf } from "./kind";

/** A position along an axis that another word names goes from end to end of the data. */
function alongAxis(c: Context): ReturnType<typeof sliderRange> {
  const axis = ["x", "y", "z"].indexOf(c.app.session.word(c.at, "axis") ?? "");
  const bounds = c.app.state && dataBounds(c.app.state);
  if (c.name !== "position" || axis < 0 || !bounds || !(bounds[2 * axis + 1] > bounds[2 * axis])) return null;
  const [min, max] = [bounds[2 * axis], bounds[2 * axis + 1]];
  return { min, max, step: (max - min) / 500 };
}

export function number(c: Context, id: string): TemplateResult {
  const range = alongAxis(c) ?? sliderRange(c.schema, fieldOf(c)?.range);
  const fallback = defaultText(c.schema);
  const value = c.value ?? "";
  const position = Number(value || fallback || (range ? (range.min + range.max) / 2 : 0));
  const marked = c.schema.unit === "@field" ? c.app.probe.valueOf(fieldOf(c)?.name) : null;
  const set = (text: string, moving = false): void => c.set(text.trim() === "" ? null : text.trim(), moving);
  const factor = range ? null : factorRange(c.schema);
  const slide = (e: Event, moving: boolean): void => set(short(Number((e.target as HTMLInputElement).value)), moving);
  // A slider of magnitudes: each decade is as long as the next.
  const slideFactor = (e: Event, moving: boolean): void => set(String(Number(Math.pow(10, Number((e.target as HTMLInputElement).value)).toPrecision(3))), moving);
  return html`${range
      ? html`<input
          type="range" min=${range.min} max=${range.max} step=${range.step} .value=${live(String(position))}
          aria-label=${c.name} class=${c.value === undefined ? "unset" : ""}
          @input=${(e: Event) => slide(e, true)} @change=${(e: Event) => slide(e, false)} />`
      : factor
        ? html`<input
          type="range" min=${Math.log10(factor.min)} max=${Math.log10(factor.max)} step="0.01" .value=${live(String(Math.log10(position)))}
          aria-label=${c.name} aria-valuetext=${plain(position)} class=${c.value === undefined ? "unset" : ""}
          @input=${(e: Event) => slideFactor(e, true)} @change=${(e: Event) => slideFactor(e, false)} />`
        : nothing}
    <input
      id=${id} class="number" type="text" inputmode="decimal" autocomplete="off" spellcheck="false" ${held(value)}
      placeholder=${fallback === "" ? "auto" : plain(Number(fallback), 6)}
      aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
      @input=${typing} @change=${(e: Event) => set(typed(e))}
      @keydown=${(e: KeyboardEvent) => {
        // Arrow keys step by the last digit that is written, as in tables.
        const by = { ArrowUp: 1, ArrowDown: -1 }[e.key];
        if (by === undefined) return;
        e.preventDefault();
        const whole = typesOf(c.schema).includes("integer");
        const x = Number((e.target as HTMLInputElement).value || fallback || 0);
        const unit = whole ? 1 : range ? (range.max - range.min) / 100 : Math.pow(10, Math.floor(Math.log10(Math.abs(x) || 1)) - 1);
        set(short(x + by * unit * (e.shiftKey ? 10 : 1)));
      }} />
    ${marked !== null ? html`<button class="small" title="The value that was clicked in the picture" @click=${() => set(short(marked))}>◎ ${plain(marked)}</button>` : nothing}`;
}
