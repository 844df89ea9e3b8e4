// SPDX-License-Identifier: Apache-2.0
// A colour: picked, or written as the command line takes it; of three numbers also as #rrggbb or by a name.
import { html, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { hexOf, hexOfNumbers, knownHex, numbersOfHex } from "./color_text";
import { describedBy, invalid } from "./control";
import type { Context } from "./form";
import { held, typed, typing } from "./held";
import { defaultText, isLinearColor, typesOf } from "./kind";

export function color(c: Context, id: string): TemplateResult {
  const fallback = defaultText(c.schema);
  const text = c.value ?? fallback;
  const [numbers, linear] = [typesOf(c.schema).includes("array"), isLinearColor(c.schema)];
  const picked = (e: Event): string => {
    const hex = (e.target as HTMLInputElement).value;
    return numbers ? numbersOfHex(hex, linear, text) : hex;
  };
  const written = (words: string): string => {
    const hex = numbers && !words.includes(",") ? knownHex(words.trim()) : null;
    return hex ? numbersOfHex(hex, linear, "") : words;
  };
  return html`<input type="color" aria-label="Pick: ${c.name}" .value=${live(numbers ? hexOfNumbers(text, linear) : hexOf(text.split("/")[0]))}
      @input=${(e: Event) => c.set(picked(e), true)} @change=${(e: Event) => c.set(picked(e))} />
    <input id=${id} type="text" ${held(c.value ?? "")} placeholder=${fallback || "auto"} spellcheck="false" autocomplete="off"
      aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
      @input=${typing} @change=${(e: Event) => c.set(written(typed(e)) || null)} />`;
}
