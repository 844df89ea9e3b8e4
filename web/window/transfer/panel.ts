// SPDX-License-Identifier: Apache-2.0
// The tab of colours: histogram, opacity, colour map, range, presets, proposals, and the second axis of volumes.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { showEntry } from "../catalog";
import { choicesOf } from "../controls/kind";
import { form } from "../controls/form";
import type { Proposal } from "../protocol";
import { quoted } from "../words";
import { coloured } from "../view/window_level";
import { colors } from "./colors";
import { curve, curveOf } from "./curve";
import { planeEditor } from "./plane_editor";

const ui: { proposals: Proposal[] | null; of: string; plane: boolean } = { proposals: null, of: "", plane: false };

export function colorPanel(app: App): TemplateResult {
  const s = app.state;
  const index = coloured(app);
  if (!s || index < 0) return html`<p class="empty">Nothing is coloured by a field. Choose a field under “Look”.</p>`;
  const shown = s.show[index];
  const entry = showEntry(app.catalog, shown.kind);
  const c = curveOf(app, index)!;
  const volume = shown.kind === "volume";
  const withFields = s.show.map((x, i) => ({ x, i })).filter(({ x }) => x.transfer);
  if (ui.of !== `${index} ${c.transfer.field}`) {
    ui.of = `${index} ${c.transfer.field}`;
    ui.proposals = null;
  }
  return html`
    ${withFields.length > 1
      ? html`<div class="chips" role="group" aria-label="What is coloured">${withFields.map(({ x, i }) => html`<button aria-pressed=${i === index ? "true" : "false"} @click=${() => app.select(`show/${i}`)}>${x.kind} of ${x.of}</button>`)}</div>`
      : nothing}
    <section><h2>${c.transfer.field}${c.transfer.unit ? html` <span class="unit">${c.transfer.unit}</span>` : nothing}</h2>
      ${curve(c)}
      ${app.session.edits.problem(`show/${index}`, "opacity") ? html`<p class="problem" role="alert">${app.session.edits.problem(`show/${index}`, "opacity")}</p>` : nothing}
    </section>
    <section><h2>Colours</h2>
      ${colors(app, index, c.transfer)}
      ${entry ? form(app, { at: `show/${index}`, entry, step: shown.of, only: ["range", "scale"] }) : nothing}
    </section>
    <section>
      <div class="row"><h2 class="grow">Proposals</h2><button class="small" @click=${() => void propose(app, index)}>${ui.proposals ? "Again" : "Propose"}</button></div>
      ${ui.proposals?.map((p) => html`<button class="proposal" @click=${() => app.session.set(`show/${index}`, p.words)}>${p.reason}</button>`)}
      ${ui.proposals?.length === 0 ? html`<p class="quiet">No proposal for this field.</p>` : nothing}
      ${volume && entry ? presets(app, index, choicesOf(entry.params.properties.preset ?? {})) : nothing}
    </section>
    ${volume && entry ? second(app, index, ui.plane || app.session.word(`show/${index}`, "widgets") !== undefined, c) : nothing}
    <section><h2>As text</h2>
      <p class="code" tabindex="0" aria-label="The command line's words">${textOf(app, index)}</p>
      <div class="row"><button class="small" @click=${() => void copy(app, textOf(app, index))}>Copy</button></div>
    </section>`;
}

function second(app: App, index: number, open: boolean, c: NonNullable<ReturnType<typeof curveOf>>): TemplateResult {
  const entry = showEntry(app.catalog, "volume")!;
  return html`<section>
    <div class="row"><h2 class="grow">Value and gradient</h2>
      <button class="small" aria-expanded=${open ? "true" : "false"} @click=${() => { ui.plane = !ui.plane; app.changed(); }}>${open ? "Close" : "Open"}</button></div>
    ${open ? html`${planeEditor(c)}${form(app, { at: `show/${index}`, entry, step: c.shown.of, only: ["second", "second_opacity"] })}` : nothing}
  </section>`;
}

function presets(app: App, index: number, names: string[]): TemplateResult {
  const now = app.session.word(`show/${index}`, "preset");
  // A preset would be hidden by words that were set before it.
  const choose = (name: string): void => app.session.set(`show/${index}`, { preset: name === now ? null : name, opacity: null, colors: null, map: null, widgets: null });
  return html`<h3>Presets</h3><div class="chips" role="group" aria-label="Presets">
    ${names.map((n) => html`<button aria-pressed=${n === now ? "true" : "false"} @click=${() => choose(n)}>${n.replaceAll("_", " ")}</button>`)}
  </div>`;
}

async function propose(app: App, index: number): Promise<void> {
  const a = await app.session.askOrSay<{ is: "proposals"; n: number; list: Proposal[] }>({ do: "proposals", show: index });
  ui.proposals = a?.list ?? null;
  app.changed();
}

/** The way to show as words of the command line, with the curve as it is seen even where it was chosen automatically. */
export function textOf(app: App, index: number): string {
  const shown = app.session.shown(index);
  if (!shown) return "";
  const words = { ...shown.words };
  const c = curveOf(app, index);
  if (c?.points && words.opacity === undefined && words.preset === undefined && words.widgets === undefined)
    words.opacity = c.points.map(([v, o]) => `@${Number(v.toPrecision(6))}:${Number(o.toPrecision(3))}`).join(",");
  if (c && words.range === undefined) words.range = c.range.map((v) => Number(v.toPrecision(6))).join(",");
  const text = Object.entries(words).map(([k, v]) => `${k}=${/[\s;]/.test(v) ? `"${v}"` : v}`).join(" ");
  return `--show ${quoted(`${shown.kind} ${text}`.trim())}`;
}

export async function copy(app: App, text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    app.say("Copied");
  } catch {
    app.say("The browser does not let pages copy here; mark the text instead");
  }
}

