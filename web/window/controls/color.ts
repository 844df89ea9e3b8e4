// SPDX-License-Identifier: Apache-2.0
// A colour: picked, or written as the command line takes it.
import { html, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { describedBy, invalid } from "./control";
import type { Context } from "./form";
import { held, typed, typing } from "./held";
import { defaultText } from "./kind";

/** What the browser makes of a colour's name, as #rrggbb; of what it does not know, grey. */
export function hexOf(text: string): string {
  if (/^#[0-9a-f]{6}$/i.test(text)) return text.toLowerCase();
  const rgb = /^([\d.]+),([\d.]+),([\d.]+)$/.exec(text);
  if (rgb) {
    const part = (s: string): string => Math.round(Math.min(1, Number(s)) * 255).toString(16).padStart(2, "0");
    return `#${part(rgb[1])}${part(rgb[2])}${part(rgb[3])}`;
  }
  if (typeof document === "undefined" || !text) return "#808080";
  const context = document.createElement("canvas").getContext("2d");
  if (!context) return "#808080";
  context.fillStyle = "#808080";
  context.fillStyle = text;
  return String(context.fillStyle).startsWith("#") ? String(context.fillStyle) : "#808080";
}

export function color(c: Context, id: string): TemplateResult {
  const fallback = defaultText(c.schema);
  return html`<input type="color" aria-label="Pick: ${c.name}" .value=${live(hexOf((c.value ?? fallback).split("/")[0]))}
      @input=${(e: Event) => c.set((e.target as HTMLInputElement).value, true)}
      @change=${(e: Event) => c.set((e.target as HTMLInputElement).value)} />
    <input id=${id} type="text" ${held(c.value ?? "")} placeholder=${fallback || "auto"} spellcheck="false" autocomplete="off"
      aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
      @input=${typing} @change=${(e: Event) => c.set(typed(e) || null)} />`;
}
