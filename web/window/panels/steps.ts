// SPDX-License-Identifier: Apache-2.0
// The tab of the pipeline: its steps as a list or as a graph, and the controls of the one that is selected.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { stepEntry } from "../catalog";
import { form } from "../controls/form";
import type { Step } from "../protocol";
import { canGo, removal, takersOf } from "../session/wiring";
import { bytes, seconds } from "../words";
import { graph } from "./graph";
import { inputs } from "./inputs";

const ui = { graph: false };

export function stepsPanel(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  const seen = app.selected.startsWith("show/") ? s.show[Number(app.selected.slice(5))]?.of : undefined;
  const chosen = s.steps.find((x) => `steps/${x.name}` === app.selected || x.name === seen) ?? null;
  const total = s.steps.some((x) => x.seconds != null) ? s.steps.reduce((n, x) => n + (x.seconds ?? 0), 0) : null;
  const memory = s.steps.reduce((n, x) => n + (x.bytes ?? 0), 0);
  return html`
    <section>
      <div class="row"><h2 class="grow">Pipeline</h2>
        <div class="segmented" role="group" aria-label="Pipeline as">
          <button aria-pressed=${!ui.graph ? "true" : "false"} @click=${() => { ui.graph = false; app.changed(); }}>list</button>
          <button aria-pressed=${ui.graph ? "true" : "false"} @click=${() => { ui.graph = true; app.changed(); }}>graph</button>
        </div>
        <button class="primary small" ?disabled=${!s.may_edit} @click=${() => app.commands.run("add")}>+ Add</button>
      </div>
      ${ui.graph ? graph(app) : html`<ul class="list">${s.steps.map((x) => item(app, x))}</ul>`}
      <p class="quiet">${s.steps.length} steps · ${seconds(total)} · ${bytes(memory)}</p>
    </section>
    ${chosen ? details(app, chosen) : html`<p class="quiet pad">Select a step to change it.</p>`}`;
}

function item(app: App, s: Step): TemplateResult {
  const at = `steps/${s.name}`;
  const indented = s.from.length > 0;
  const index = app.state!.show.findIndex((v) => v.of === s.name);
  return html`<li class="item ${app.selected === at ? "chosen" : ""}">
    <button class="grow item-name ${indented ? "indented" : ""}" aria-pressed=${app.selected === at ? "true" : "false"} @click=${() => app.select(at)}>
      <span>${s.name}</span><span class="quiet">${s.operation === s.name ? "" : s.operation}${s.from.length > 1 || (s.from.length === 1 && s.from[0] !== app.state!.steps[0].name) ? ` ← ${s.from.join(", ")}` : ""}</span>
    </button>
    <span class="quiet numbers">${seconds(s.seconds)}<br />${bytes(s.bytes)}</span>
    <button class="icon small" aria-pressed=${index >= 0 ? "true" : "false"} title=${index >= 0 ? "Shown; click to hide" : "Not shown; click to show"}
      aria-label="Show ${s.name}" ?disabled=${!app.state!.may_edit}
      @click=${() => app.session.edit(index >= 0 ? [{ remove: `show/${index}` }] : [{ add: "show", kind: showKind(s), of: s.name, set: {} }])}>${icon(index >= 0 ? "eye" : "hidden")}</button>
  </li>`;
}

/** The way to show that suits a kind of mesh. */
export function showKind(s: Pick<Step, "kind" | "operation">): string {
  if (s.kind === "points") return "points";
  if (s.kind === "uniform" || s.kind === "rectilinear") return "volume";
  return /lines$/.test(s.operation) ? "lines" : "surface";
}

function details(app: App, s: Step): TemplateResult {
  const entry = stepEntry(app.catalog, s.operation);
  const at = `steps/${s.name}`;
  const input = s.from[0] ?? s.name;
  const takers = takersOf(app.state!, s.name);
  return html`<section>
    <div class="row"><h2 class="grow clipped" title=${s.name}>${s.name}</h2>
      <button class="icon small" aria-label="Remove ${s.name}" title=${s.from.length > 0 && takers.length > 0 ? `Remove; what takes it takes ${s.from[0]}` : "Remove"}
        ?disabled=${!app.state!.may_edit || !canGo(app.state!, s)} @click=${() => app.session.edit([removal(app.state!, s)])}>${icon("close")}</button>
    </div>
    <div class="row">
      <button class="small" title="Add an operation that takes this step" ?disabled=${!app.state!.may_edit} @click=${() => app.commands.run("add")}>+ after</button>
      <button class="small" title="Insert an operation between this step and what takes it" ?disabled=${!app.state!.may_edit || takers.length === 0}
        @click=${() => app.insert(s.name, takers.map((t) => t.place))}>+ between</button>
      <button class="small" @click=${() => app.open("table")}>Table</button>
    </div>
    ${app.session.edits.problem(at, "") ? html`<p class="problem" role="alert">${app.session.edits.problem(at, "")}</p>` : nothing}
    <p class="quiet">${entry?.sentence ?? s.operation}</p>
    <p class="facts">${s.kind ?? "not run yet"}${s.size ? html` · ${s.size}` : nothing} · ${seconds(s.seconds)} · ${bytes(s.bytes)}</p>
    ${s.fields && s.fields.length > 0
      ? html`<details class="more"><summary>${s.fields.length} ${s.fields.length === 1 ? "field" : "fields"}</summary><ul class="field-list">
          ${s.fields.map((f) => html`<li><span>${f.name}</span><span class="quiet">${f.on}${f.components > 1 ? ` ×${f.components}` : ""} ${f.range ? `${Number(f.range[0].toPrecision(4))} … ${Number(f.range[1].toPrecision(4))}` : ""} ${f.unit ?? ""}</span></li>`)}
        </ul></details>`
      : nothing}
    ${inputs(app, s, entry)}
    ${entry ? form(app, { at, entry, step: input, without: s.operation === "read" ? ["path"] : [] }) : html`<p class="empty">The catalogue does not know '${s.operation}'.</p>`}
  </section>`;
}
