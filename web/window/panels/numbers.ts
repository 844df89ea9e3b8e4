// SPDX-License-Identifier: Apache-2.0
// The tab of numbers: statistics and integrals of a part of the data, and what was measured in the picture.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Tool } from "../app";
import { icon } from "../icons";
import { summary } from "../measure/rulers";
import type { MeasuredField, MeasuresAnswer, Vec3 } from "../protocol";
import { download } from "../questions/files";
import { numbers, plain, short } from "../words";

export function numbersPanel(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  const q = app.selections;
  q.prepare();
  return html`<section>
      <h2>Numbers of a selection</h2>
      <div class="row"><select class="grow" aria-label="Step of the selection" @change=${(e: Event) => q.change({ step: (e.target as HTMLSelectElement).value })}>
        ${s.steps.filter((x) => x.kind !== "table").map((x) => html`<option ?selected=${x.name === q.step}>${x.name}</option>`)}</select></div>
      ${byValue(app)}${byBox(app)}${byOutline(app)}
      <div class="row"><button class="primary small" ?disabled=${q.asking} @click=${() => void q.ask()}>${q.asking ? "Measuring …" : "Measure"}</button>
        <span class="grow"></span>
        <button class="small" ?disabled=${!q.answer} @click=${() => download(`${q.step}_numbers.csv`, "text/csv", q.csv())}>CSV</button>
        <button class="small" title="Add steps that select the same cells" ?disabled=${!s.may_edit || !q.answer || q.answer.steps.length === 0 || q.asking} @click=${() => void q.addSteps()}>As a step</button></div>
      ${q.problem ? html`<p class="problem" role="alert">${q.problem}</p>` : nothing}
      ${q.answer ? table(q.answer) : nothing}
    </section>
    ${measuredSection(app)}`;
}

function byValue(app: App): TemplateResult {
  const q = app.selections;
  const [lo, hi] = q.valueRange;
  const [a, b] = q.range ?? [lo, hi];
  const step = (hi - lo) / 1000 || 1;
  const end = (name: string, value: number, set: (v: number) => [number, number]): TemplateResult => {
    const take = (e: Event): void => {
      const v = Number((e.target as HTMLInputElement).value);
      if (Number.isFinite(v)) q.change({ range: set(v) });
    };
    return html`<div class="row range-row"><span class="end-name">${name}</span>
      <input class="grow" type="range" aria-label="${name} value" min=${lo} max=${hi} step=${step} .value=${String(value)} @change=${take} />
      <input class="number" type="text" inputmode="decimal" aria-label="${name} value as a number" .value=${short(value)} @change=${take} /></div>`;
  };
  return html`<div class="row"><label class="row"><input type="checkbox" .checked=${q.range !== null} @change=${(e: Event) => q.change({ range: (e.target as HTMLInputElement).checked ? [lo, hi] : null })} />by value</label>
      ${q.range
        ? html`<select class="grow" aria-label="Field of the selection" @change=${(e: Event) => {
            q.valueField = (e.target as HTMLSelectElement).value;
            q.change({ range: [...q.valueRange] });
          }}>${q.fields().map((f) => html`<option ?selected=${f.name === q.valueField}>${f.name}</option>`)}</select>`
        : nothing}</div>
    ${q.range ? html`${end("from", a, (v) => [Math.min(v, b), b])}${end("to", b, (v) => [a, Math.max(v, a)])}` : nothing}`;
}

const sides = ["x from", "x to", "y from", "y to", "z from", "z to"];

function byBox(app: App): TemplateResult {
  const q = app.selections;
  const { box } = q;
  return html`<div class="row"><label class="row"><input type="checkbox" .checked=${box !== null} @change=${(e: Event) => q.change({ box: (e.target as HTMLInputElement).checked ? q.boxOfData() : null })} />by a box</label></div>
    ${box
      ? html`<div class="vector n6" role="group" aria-label="Box">${box.map((v, i) => html`<input class="number" type="text" inputmode="decimal" aria-label=${sides[i]} title=${sides[i]} .value=${short(v)} @change=${(e: Event) => {
          const x = Number((e.target as HTMLInputElement).value);
          if (Number.isFinite(x)) q.change({ box: box.map((old, k) => (k === i ? x : old)) });
        }} />`)}</div>`
      : nothing}`;
}

function byOutline(app: App): TemplateResult {
  const q = app.selections;
  const tool = (t: Tool, name: string): TemplateResult =>
    html`<button class="small" aria-pressed=${app.tool === t ? "true" : "false"} @click=${() => app.commands.run(app.tool === t ? "tool-turn" : `tool-${t}`)}>${name}</button>`;
  return html`<div class="row wrap"><span>drawn</span>${tool("rectangle", "Rectangle")}${tool("lasso", "Outline")}
    <button class="small" @click=${() => q.allSeen(app.view)} title="All that is seen">All seen</button>
    ${q.hasOutline ? html`<button class="icon small" aria-label="Without the outline" title="Without the outline" @click=${() => q.clearOutline()}>${icon("close")}</button>` : nothing}</div>`;
}

const measureNames = ["", "length", "area", "volume"];
const powers = ["", "", "²", "³"];

/** What is selected, in a sentence. */
export function selectedText(a: MeasuresAnswer): string {
  const d = a.dimension ?? 0;
  const size = a.measure !== null && d > 0 ? [`${measureNames[d]} ${plain(a.measure, 6)}${a.length_unit ? ` ${a.length_unit}${powers[d]}` : ""}`] : [];
  return [`${a.points.toLocaleString("en")} points`, `${a.cells.toLocaleString("en")} cells`, ...size].join(" · ");
}

function table(a: MeasuresAnswer): TemplateResult {
  const d = a.dimension ?? 0;
  const over = a.length_unit && d > 0 ? ` ${a.length_unit}${powers[d]}` : "";
  const name = (f: MeasuredField): string => `${f.name}${f.component >= 0 ? ` ${"xyz"[f.component] ?? f.component}` : ""}`;
  const row = (f: MeasuredField): TemplateResult => html`<tr><th scope="row">${name(f)}${f.unit ? html` <span class="unit">${f.unit}</span>` : nothing}</th>
    ${[f.mean, f.deviation, f.median, f.min, f.max].map((v) => html`<td>${plain(v, 5)}</td>`)}
    <td>${plain(f.integral, 6)}${f.integral !== null && (f.unit || over) ? html` <span class="unit">${f.unit}${over}</span>` : nothing}</td>
    <td>${f.count.toLocaleString("en")}</td><td>${f.missing.toLocaleString("en")}</td><td>${f.on}</td></tr>`;
  return html`<p class="facts selected-facts">${selectedText(a)}</p>
    ${a.fields.length > 0
      ? html`<div class="table-scroll measures-table" tabindex="0" role="region" aria-label="Statistics and integrals"><table class="numbers-table">
          <thead><tr><th scope="col">field</th>${["mean", "deviation", "median", "min", "max", "integral", "count", "missing", "on"].map((c) => html`<th scope="col">${c}</th>`)}</tr></thead>
          <tbody>${a.fields.map(row)}</tbody></table></div>`
      : nothing}`;
}

function measuredSection(app: App): TemplateResult {
  const { rulers } = app;
  const unit = app.state?.length_unit ?? "";
  const now = rulers.points.length;
  return html`<section>
    <h2>Measured in the picture</h2>
    <div class="row wrap">
      <button class="small" aria-pressed=${app.tool === "measure" ? "true" : "false"} @click=${() => app.commands.run(app.tool === "measure" ? "tool-turn" : "tool-measure")}>${app.tool === "measure" ? "Click in the picture" : "Measure"}</button>
      <button class="small" ?disabled=${now < 2} @click=${() => rulers.keep()}>Keep</button>
      <button class="small" ?disabled=${now === 0} title="Take the last place away" @click=${() => rulers.back()}>Back</button>
      <button class="small" ?disabled=${rulers.kept.length === 0} @click=${() => download("measurements.csv", "text/csv", rulers.csv())}>CSV</button>
    </div>
    <p class="facts measured-now">${now === 0 ? html`<span class="quiet">no place yet</span>` : now === 1 ? "one place" : summary(rulers.points, unit)}</p>
    <label class="control"><span>place x, y, z</span><input type="text" placeholder="typed instead of clicked" @change=${(e: Event) => {
      const box = e.target as HTMLInputElement;
      const p = numbers(box.value);
      if (p?.length !== 3) return app.say("A place is three numbers: x, y, z");
      rulers.add(p as Vec3);
      box.value = "";
    }} /></label>
    ${rulers.kept.length > 0
      ? html`<ul class="list kept-list">${rulers.kept.map(
          (m, i) => html`<li class="item"><input class="kept-name" type="text" aria-label="Name of measurement ${i + 1}" .value=${m.name} @change=${(e: Event) => rulers.rename(i, (e.target as HTMLInputElement).value)} />
            <span class="grow kept-text">${summary(m.points, unit)}</span>
            <button class="icon small" aria-label="Remove ${m.name}" title="Remove" @click=${() => rulers.drop(i)}>${icon("close")}</button></li>`,
        )}</ul>`
      : nothing}
  </section>`;
}
