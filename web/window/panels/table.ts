// SPDX-License-Identifier: Apache-2.0
// The numbers of a step as a table, a page at a time.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { csv, download } from "../questions/files";
import type { RowsAnswer } from "../protocol";

const page = 50;
const ui: { step: string; on: string; from: number; answer: RowsAnswer | null; key: string; problem: string } = {
  step: "", on: "point", from: 0, answer: null, key: "", problem: "",
};

export function tablePanel(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  if (app.selected.startsWith("steps/") && ui.step !== app.selected.slice(6)) {
    ui.step = app.selected.slice(6);
    ui.from = 0;
  }
  if (!s.steps.some((x) => x.name === ui.step)) ui.step = s.show[0]?.of ?? s.steps[0]?.name ?? "";
  const key = `${s.revision} ${ui.step} ${ui.on} ${ui.from}`;
  if (key !== ui.key) {
    ui.key = key;
    void ask(app, key);
  }
  const a = ui.answer;
  const go = (from: number): void => {
    ui.from = Math.max(0, Math.min(from, (a?.total ?? 1) - 1));
    app.changed();
  };
  return html`<section class="table-panel">
    <div class="row wrap">
      <select aria-label="Step" @change=${(e: Event) => app.select(`steps/${(e.target as HTMLSelectElement).value}`)}>${s.steps.map((x) => html`<option ?selected=${x.name === ui.step}>${x.name}</option>`)}</select>
      <select aria-label="Of" @change=${(e: Event) => { ui.on = (e.target as HTMLSelectElement).value; go(0); }}>
        ${["point", "cell"].map((o) => html`<option value=${o} ?selected=${o === ui.on}>${o}s</option>`)}</select>
      <span class="grow"></span>
      <button class="small" ?disabled=${!a || a.rows.length === 0} @click=${() => void save(app)}>CSV</button>
    </div>
    ${ui.problem ? html`<p class="problem" role="alert">${ui.problem}</p>` : nothing}
    ${a
      ? html`<div class="table-scroll" tabindex="0" role="region" aria-label="Numbers of ${ui.step}"><table class="numbers-table">
          <thead><tr><th scope="col">#</th>${a.columns.map((c) => html`<th scope="col">${c}</th>`)}</tr></thead>
          <tbody>${a.rows.map((r, i) => html`<tr><th scope="row">${ui.from + i}</th>${r.map((v) => html`<td>${v}</td>`)}</tr>`)}</tbody>
        </table></div>
        <div class="row">
          <button class="small" aria-label="Back" ?disabled=${ui.from === 0} @click=${() => go(ui.from - page)}>${icon("left")}</button>
          <label class="grow row">from <input class="number" inputmode="numeric" .value=${String(ui.from)} @change=${(e: Event) => go(Number((e.target as HTMLInputElement).value) || 0)} /></label>
          <span class="quiet">of ${a.total}</span>
          <button class="small" aria-label="On" ?disabled=${ui.from + page >= a.total} @click=${() => go(ui.from + page)}>${icon("right")}</button>
        </div>`
      : html`<p class="empty">${ui.problem ? "" : "Reading …"}</p>`}
  </section>`;
}

async function ask(app: App, key: string): Promise<void> {
  try {
    const a = await app.session.ask<RowsAnswer>({ do: "rows", step: ui.step, on: ui.on, from: ui.from, count: page });
    if (ui.key !== key) return;
    ui.answer = a;
    ui.problem = "";
  } catch (error) {
    if (ui.key !== key) return;
    ui.answer = null;
    ui.problem = (error as Error).message;
  }
  app.changed();
}

/** All rows, in portions that fit into messages; more than a million are better converted by the command line. */
async function save(app: App): Promise<void> {
  const { step, on } = ui;
  const total = Math.min(ui.answer?.total ?? 0, 1_000_000);
  const rows: string[][] = [];
  let columns: string[] = [];
  while (rows.length < total) {
    const a = await app.session.askOrSay<RowsAnswer>({ do: "rows", step, on, from: rows.length, count: Math.min(1000, total - rows.length) });
    if (!a || a.rows.length === 0) break;
    columns = a.columns;
    rows.push(...a.rows);
  }
  download(`${step}.csv`, "text/csv", csv(columns, rows));
  if ((ui.answer?.total ?? 0) > total) app.say(`The first ${total} rows were saved; sightglass convert writes all of them`);
}
