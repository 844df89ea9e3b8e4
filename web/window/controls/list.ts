// SPDX-License-Identifier: Apache-2.0
// Several numbers: a fixed count, as a point or a direction, or as many as are wanted.
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import { numbers, plain, short } from "../words";
import { describedBy, fieldOf, invalid } from "./control";
import type { Context } from "./form";
import { held, typed, typing } from "./held";
import { shiftReach } from "./reach";

const letters = ["x", "y", "z"];

export function vector(c: Context, id: string): TemplateResult {
  const count = c.schema.minItems ?? 3;
  const fallback = Array.isArray(c.schema.default) ? (c.schema.default as number[]) : [];
  const now = c.value === undefined ? [] : c.value.split(/[,\s]+/);
  const names = count === 3 ? letters : count === 6 ? ["x from", "x to", "y from", "y to", "z from", "z to"] : Array.from({ length: count }, (_, i) => String(i + 1));
  const set = (i: number, text: string, moving = false): void => {
    const next = names.map((_, k) => (k === i ? text.trim() : (now[k] ?? String(fallback[k] ?? "0"))));
    c.set(next.every((s) => s === "") || (text.trim() === "" && c.value === undefined) ? null : next.map((s) => s || "0").join(","), moving);
  };
  const reach = shiftReach(c);
  return html`<div class="vector n${count}" role="group" aria-label=${c.name}>
      ${names.map(
        (name, i) => html`<input id=${i === 0 ? id : nothing} type="text" inputmode="decimal" class="number" ${held(now[i] ?? "")} aria-label="${c.name} ${name}"
          placeholder=${fallback[i] === undefined ? name : plain(fallback[i])} aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
          autocomplete="off" @input=${typing} @change=${(e: Event) => set(i, typed(e))} />`,
      )}
      ${reach === null
        ? nothing
        : names.map((name, i) => {
            const slide = (e: Event, moving: boolean): void => set(i, short(Number((e.target as HTMLInputElement).value)), moving);
            return html`<input type="range" min=${-reach} max=${reach} step=${reach / 200} .value=${live(now[i] ?? "0")} class=${c.value === undefined ? "unset" : ""}
              aria-label="Drag: ${c.name} ${name}" @input=${(e: Event) => slide(e, true)} @change=${(e: Event) => slide(e, false)} />`;
          })}
    </div>
    ${count === 3 ? pinnedPoint(c) : nothing}`;
}

/** The place that was clicked in the picture, for points. */
function pinnedPoint(c: Context): TemplateResult | typeof nothing {
  const p = c.app.probe.pinned?.answer.position;
  if (!p || !/^(origin|center|from|to|position|target)$/.test(c.name)) return nothing;
  return html`<button class="small" title="The place that was clicked in the picture" @click=${() => c.set(p.map(short).join(","))}>◎ clicked place</button>`;
}

export function list(c: Context, id: string): TemplateResult {
  const fallback = Array.isArray(c.schema.default) ? (c.schema.default as number[]).join(", ") : "";
  const f = c.schema.unit === "@field" ? fieldOf(c) : undefined;
  const values = c.value === undefined ? [] : (numbers(c.value) ?? []);
  const range = f?.range && f.range[1] > f.range[0] ? f.range : null;
  // A single value of a field can be dragged; of several each has its own slider.
  const sliders = range && /^(values|levels)$/.test(c.name) ? (values.length > 0 ? values : [(range[0] + range[1]) / 2]) : [];
  const at = (i: number, x: number): string => sliders.map((v, k) => short(k === i ? x : v)).join(",");
  const marked = f && c.name !== "range" ? c.app.probe.valueOf(f.name) : null;
  return html`${sliders.slice(0, 6).map(
      (v, i) => html`<input type="range" min=${range![0]} max=${range![1]} step=${(range![1] - range![0]) / 500} .value=${String(v)}
        class=${c.value === undefined ? "unset" : ""} aria-label="${c.name} ${i + 1}"
        @input=${(e: Event) => c.set(at(i, Number((e.target as HTMLInputElement).value)), true)}
        @change=${(e: Event) => c.set(at(i, Number((e.target as HTMLInputElement).value)))} />`,
    )}
    <input id=${id} type="text" inputmode="text" autocomplete="off" spellcheck="false" ${held(c.value ?? "")} placeholder=${fallback || "auto"}
      aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)} @input=${typing} @change=${(e: Event) => c.set(typed(e).trim() || null)} />
    ${marked !== null
      ? html`<button class="small" title="Add the value that was clicked in the picture" @click=${() => c.set([...values, marked].map(short).join(","))}>◎ + ${plain(marked)}</button>`
      : nothing}`;
}

/** The two ends of a range of values, those of the data where none are given. */
export function ends(c: Context, id: string): TemplateResult {
  const now = c.value === undefined ? [] : c.value.split(",");
  const index = c.at.startsWith("show/") ? Number(c.at.slice(5)) : -1;
  const chosen = c.app.session.shown(index)?.transfer?.range ?? fieldOf(c)?.range ?? null;
  const set = (i: 0 | 1, text: string): void => {
    const next = [0, 1].map((k) => (k === i ? text.trim() : (now[k] ?? (chosen ? short(chosen[k]) : ""))));
    c.set(next[i] === "" ? null : next.join(","));
  };
  const box = (i: 0 | 1): TemplateResult => html`<input id=${i === 0 ? id : nothing} type="text" inputmode="decimal" class="number" autocomplete="off" ${held(now[i] ?? "")}
    aria-label="${c.name} ${i === 0 ? "from" : "to"}" placeholder=${chosen ? plain(chosen[i]) : i === 0 ? "from" : "to"} aria-invalid=${invalid(c)} aria-describedby=${describedBy(c, id)}
    @input=${typing} @change=${(e: Event) => set(i, typed(e))} />`;
  return html`<div class="vector n6" role="group" aria-label=${c.name}>${box(0)}${box(1)}</div>`;
}
