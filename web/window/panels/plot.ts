// SPDX-License-Identifier: Apache-2.0
// The tab of the plot over a line: its ends, its curve, and its export as numbers and as a figure.
import { html, nothing, type TemplateResult } from "lit";
import { ref } from "lit/directives/ref.js";
import type { App } from "../app";
import type { LineAnswer, Vec3 } from "../protocol";
import { figure } from "../questions/figure";
import { csv, download } from "../questions/files";
import { numbers, short } from "../words";

export function plotPanel(app: App): TemplateResult {
  const s = app.state;
  const { lines } = app;
  if (!s) return html``;
  lines.prepare();
  const fields = (s.steps.find((x) => x.name === lines.step)?.fields ?? []).filter((f) => f.on !== "whole");
  const end = (name: "from" | "to"): TemplateResult => html`<label class="control"><span>${name}</span>
    <input type="text" .value=${(lines[name] ?? []).map(short).join(", ")} @change=${(e: Event) => {
      const p = numbers((e.target as HTMLInputElement).value);
      if (p?.length === 3) {
        lines[name] = p as Vec3;
        void lines.ask();
      } else app.say("A point is three numbers: x, y, z");
    }} /></label>`;
  const label = `${lines.field}${lines.answer?.unit ? ` (${lines.answer.unit})` : ""}`;
  const distance = `distance${s.length_unit ? ` (${s.length_unit})` : ""}`;
  return html`<section>
    <h2>Plot over a line</h2>
    <div class="row"><button class="small" aria-pressed=${app.tool === "line" ? "true" : "false"} @click=${() => app.commands.run(app.tool === "line" ? "tool-turn" : "tool-line")}>${app.tool === "line" ? "Drag from end to end in the picture" : "Draw the line in the picture"}</button></div>
    <div class="row wrap">
      <select aria-label="Step" @change=${(e: Event) => { lines.step = (e.target as HTMLSelectElement).value; void lines.ask(); }}>${s.steps.map((x) => html`<option ?selected=${x.name === lines.step}>${x.name}</option>`)}</select>
      <select aria-label="Field" class="grow" @change=${(e: Event) => { lines.field = (e.target as HTMLSelectElement).value; void lines.ask(); }}>${fields.map((f) => html`<option ?selected=${f.name === lines.field}>${f.name}</option>`)}</select>
    </div>
    ${end("from")}${end("to")}
    <label class="control"><span>points</span><input class="number" inputmode="numeric" .value=${String(lines.count)} @change=${(e: Event) => {
      lines.count = Math.max(2, Math.min(10000, Math.round(Number((e.target as HTMLInputElement).value)) || 200));
      void lines.ask();
    }} /></label>
    ${lines.problem ? html`<p class="problem" role="alert">${lines.problem}</p>` : nothing}
    ${lines.answer
      ? html`<div class="uplot-holder" role="img" aria-label="${label} along the line, ${summary(lines.answer)}" ${ref((e) => draw(e as HTMLElement | undefined, app, lines.answer!, label, distance))}></div>
        <div class="row">
          <button class="small" @click=${() => download(`${lines.field}_line.csv`, "text/csv", csv([distance, label], lines.answer!.distance.map((d, i) => [d, lines.answer!.values[i]])))}>CSV</button>
          <button class="small" @click=${() => download(`${lines.field}_line.svg`, "image/svg+xml", figure(lines.answer!, distance, label))}>Figure (SVG)</button>
        </div>`
      : html`<div class="row"><button class="primary" @click=${() => void lines.ask()}>Plot</button></div>`}
  </section>`;
}

function summary(a: LineAnswer): string {
  const v = a.values.filter((x): x is number => x !== null);
  return v.length > 0 ? `from ${short(Math.min(...v))} to ${short(Math.max(...v))}` : "outside of the data";
}

/** The plotting library comes with the first plot, not with the page. */
function draw(holder: HTMLElement | undefined, app: App, answer: LineAnswer, label: string, distance: string): void {
  import("./curve_plot").then((m) => m.drawCurve(holder, answer, label, distance)).catch(() => app.say("The plot could not be loaded"));
}
