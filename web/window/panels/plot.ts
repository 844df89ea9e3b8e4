// SPDX-License-Identifier: Apache-2.0
// The tab of plots: values over a line and over time, their curves, and their export as numbers and as figures.
import { html, nothing, type TemplateResult } from "lit";
import { ref } from "lit/directives/ref.js";
import type { App } from "../app";
import type { Vec3 } from "../protocol";
import type { Curve } from "../questions/curve";
import { figure } from "../questions/figure";
import { csv, download } from "../questions/files";
import { numbers, short } from "../words";

export function plotPanel(app: App): TemplateResult {
  if (!app.state) return html``;
  return html`${app.state.times.length > 1 ? overTime(app) : nothing}${overLine(app)}`;
}

function overLine(app: App): TemplateResult {
  const s = app.state!;
  const { lines } = app;
  lines.prepare();
  const fields = (s.steps.find((x) => x.name === lines.step)?.fields ?? []).filter((f) => f.on !== "whole");
  const take = (set: () => void): void => {
    set();
    void lines.ask();
  };
  const a = lines.answer;
  return html`<section>
    <h2>Plot over a line</h2>
    <div class="row"><button class="small" aria-pressed=${app.tool === "line" ? "true" : "false"} @click=${() => app.commands.run(app.tool === "line" ? "tool-turn" : "tool-line")}>${app.tool === "line" ? "Drag from end to end in the picture" : "Draw the line in the picture"}</button></div>
    ${choices("", s.steps.map((x) => x.name), lines.step, fields.map((f) => f.name), lines.field, (step) => take(() => (lines.step = step)), (field) => take(() => (lines.field = field)))}
    ${place(app, "from", lines.from, (p) => take(() => (lines.from = p)))}${place(app, "to", lines.to, (p) => take(() => (lines.to = p)))}
    <label class="control"><span>points</span><input class="number" inputmode="numeric" .value=${String(lines.count)} @change=${(e: Event) =>
      take(() => (lines.count = Math.max(2, Math.min(10000, Math.round(Number((e.target as HTMLInputElement).value)) || 200))))} /></label>
    ${lines.problem ? html`<p class="problem" role="alert">${lines.problem}</p>` : nothing}
    ${a
      ? curve(app, "line", { x: a.distance, values: a.values }, withUnit(lines.field, a.unit), withUnit("distance", s.length_unit), `${lines.field}_line`)
      : html`<div class="row"><button class="primary" @click=${() => void lines.ask()}>Plot</button></div>`}
  </section>`;
}

function overTime(app: App): TemplateResult {
  const { overTime: o } = app;
  o.prepare();
  const a = o.answer;
  const clicked = o.clicked;
  return html`<section class="over-time">
    <h2>Plot over time</h2>
    <p class="quiet">At one place, for all ${app.state!.times.length} times. Click a place in the picture, or type it.</p>
    ${choices(" over time", app.state!.steps.filter((x) => x.kind !== "table").map((x) => x.name), o.step, o.fields(), o.field, (step) => { o.step = step; app.changed(); }, (field) => { o.field = field; app.changed(); })}
    ${place(app, "at", o.at, (p) => { o.at = p; app.changed(); })}
    <div class="row">
      <button class="small" ?disabled=${!clicked} @click=${() => { o.at = clicked; void o.ask(); }}>At the clicked place</button>
      <button class="primary small" ?disabled=${!o.at || o.asking} @click=${() => void o.ask()}>${o.asking ? "Reading all times …" : "Plot over time"}</button>
    </div>
    ${o.problem ? html`<p class="problem" role="alert">${o.problem}</p>` : nothing}
    ${a ? curve(app, "time", { x: a.times, values: a.values }, withUnit(o.field, a.unit), "time", `${o.field}_time`) : nothing}
    ${a && a.gaps?.length ? html`<p class="quiet" role="status">${a.gaps.length === 1 ? "One time" : `${a.gaps.length} times`} could not be read and ${a.gaps.length === 1 ? "is" : "are"} left out: ${a.gaps[0].text}${a.gaps.length > 1 ? " …" : ""}</p>` : nothing}
  </section>`;
}

const withUnit = (name: string, unit?: string): string => `${name}${unit ? ` (${unit})` : ""}`;

function choices(which: string, steps: string[], step: string, fields: string[], field: string, onStep: (s: string) => void, onField: (f: string) => void): TemplateResult {
  const value = (e: Event): string => (e.target as HTMLSelectElement).value;
  return html`<div class="row wrap">
    <select aria-label="Step${which}" @change=${(e: Event) => onStep(value(e))}>${steps.map((x) => html`<option ?selected=${x === step}>${x}</option>`)}</select>
    <select aria-label="Field${which}" class="grow" @change=${(e: Event) => onField(value(e))}>${fields.map((f) => html`<option ?selected=${f === field}>${f}</option>`)}</select>
  </div>`;
}

function place(app: App, name: string, at: Vec3 | null, take: (p: Vec3) => void): TemplateResult {
  return html`<label class="control"><span>${name}</span>
    <input type="text" .value=${(at ?? []).map(short).join(", ")} @change=${(e: Event) => {
      const p = numbers((e.target as HTMLInputElement).value);
      if (p?.length === 3) take(p as Vec3);
      else app.say("A point is three numbers: x, y, z");
    }} /></label>`;
}

/** A curve with the files that can be made of it. */
function curve(app: App, name: string, c: Curve, label: string, xLabel: string, file: string): TemplateResult {
  return html`<div class="uplot-holder" role="img" aria-label="${label} over ${xLabel}, ${summary(c)}" ${ref((e) => draw(name, e as HTMLElement | undefined, app, c, label, xLabel))}></div>
    <div class="row">
      <button class="small" @click=${() => download(`${file}.csv`, "text/csv", csv([xLabel, label], c.x.map((x, i) => [x, c.values[i]])))}>CSV</button>
      <button class="small" @click=${() => download(`${file}.svg`, "image/svg+xml", figure(c, xLabel, label))}>Figure (SVG)</button>
    </div>`;
}

function summary(c: Curve): string {
  const v = c.values.filter((x): x is number => x !== null);
  return v.length > 0 ? `from ${short(Math.min(...v))} to ${short(Math.max(...v))}` : "outside of the data";
}

/** The plotting library comes with the first plot, not with the page. */
function draw(name: string, holder: HTMLElement | undefined, app: App, c: Curve, label: string, xLabel: string): void {
  import("./curve_plot").then((m) => m.drawCurve(name, holder, c, label, xLabel)).catch(() => app.say("The plot could not be loaded"));
}
