// SPDX-License-Identifier: Apache-2.0
// What a step takes: a choice for each of its inputs.
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { App } from "../app";
import type { Entry } from "../catalog";
import type { Step } from "../protocol";
import { mayTake, slotsOf, withInput, type Slot } from "../session/wiring";

export function inputs(app: App, step: Step, entry: Entry | undefined): TemplateResult | typeof nothing {
  const slots = slotsOf(entry, step.from);
  if (slots.length === 0) return nothing;
  const s = app.state!;
  const others = mayTake(s.steps, step.name);
  const take = (index: number, takes: string): void => {
    if (takes !== slots[index].takes) app.session.edit([{ at: `steps/${step.name}`, from: withInput(step.from, index, takes) }]);
  };
  const slot = (x: Slot, i: number): TemplateResult => {
    const id = `takes-${step.name}-${i}`.replace(/[^\w-]/g, "-");
    const label = i === 0 ? "Takes" : x.takes === "" && x.optional ? "Further input" : `Input ${i + 1}`;
    return html`<div class="control" data-input=${i}>
      <div class="control-head"><label for=${id}>${label}</label></div>
      <div class="control-body"><select id=${id} ?disabled=${!s.may_edit} .value=${live(x.takes)} @change=${(e: Event) => take(i, (e.target as HTMLSelectElement).value)}>
        ${x.optional || x.takes === "" ? html`<option value="" ?selected=${x.takes === ""}>nothing</option>` : nothing}
        ${others.map((o) => html`<option value=${o.name} ?selected=${o.name === x.takes}>${o.name}${o.kind ? ` (${o.kind})` : ""}</option>`)}
      </select></div></div>`;
  };
  return html`<div class="form inputs" role="group" aria-label="What ${step.name} takes">${slots.map(slot)}</div>`;
}
