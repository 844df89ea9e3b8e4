// SPDX-License-Identifier: Apache-2.0
// The nodes of the scene: where each stands, and what is shown there.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { named } from "../catalog";
import { form } from "../controls/form";
import { icon } from "../icons";
import { nodeEntries } from "./node_entries";
import type { Edit, SceneNode, Shown, State } from "../protocol";

const begin = ["translate", "scale", "angle", "axis", "center", "euler", "order", "visible"];

export function nodesPanel(app: App): TemplateResult {
  const s = app.state!;
  const chosen = s.scene.find((n) => `scene/${n.name}` === app.selected);
  return html`<section>
      <div class="row"><h2 class="grow">Nodes</h2>${addNode(app, s, "")}</div>
      ${s.scene.length === 0
        ? html`<p class="quiet">All is shown where the data lie. What stands in a node is moved, turned and scaled with it.</p>`
        : html`<ul class="list">${s.scene.map((n) => item(app, s, n, n === chosen))}</ul>`}
    </section>
    ${chosen ? details(app, s, chosen) : nothing}`;
}

function item(app: App, s: State, n: SceneNode, chosen: boolean): TemplateResult {
  const at = `scene/${n.name}`;
  const shows = s.show.filter((x) => x.in === n.name).map(textOf).join(", ");
  return html`<li class="item depth-${Math.min(4, depthOf(s, n))} ${chosen ? "chosen" : ""}">
    <button class="grow item-name" aria-pressed=${chosen ? "true" : "false"} @click=${() => app.select(at)}><span>${n.name}</span><span class="quiet">${shows}</span></button>
    <button class="icon small" aria-label="Remove node ${n.name}, with all that is in it" title="Remove, with all that is in it" ?disabled=${!s.may_edit}
      @click=${() => app.session.edit([{ remove: at }])}>${icon("close")}</button></li>`;
}

function details(app: App, s: State, n: SceneNode): TemplateResult {
  const at = `scene/${n.name}`;
  const entry = named(app.catalog.nodes, "node");
  const problem = app.session.edits.problem(at, "");
  const inside = s.show.map((x, i) => ({ x, i })).filter(({ x }) => x.in === n.name);
  const copies = n.copies_of ? `copies at the points of ${n.copies_of}` : n.copies > 0 ? `${n.copies} copies` : "";
  const facts = [n.in ? `in ${n.in}` : "", copies, n.keys > 0 ? `moves by ${n.keys} keys` : ""].filter(Boolean).join(" · ");
  return html`<section>
    <div class="row"><h2 class="grow">Node ${n.name}</h2>${addNode(app, s, n.name)}</div>
    ${facts ? html`<p class="facts">${facts}</p>` : nothing}
    ${problem ? html`<p class="problem" role="alert">${problem}</p>` : nothing}
    ${entry ? form(app, n.keys > 0 ? { at, entry, begin: ["time", ...begin] } : { at, entry, begin, without: ["time"] }) : nothing}
    <div class="row"><h3 class="grow">Shown here</h3>${putHere(app, s, n)}</div>
    ${inside.length === 0 ? html`<p class="quiet">Nothing yet.</p>` : nothing}
    <ul class="list">${inside.map(
      ({ x, i }) => html`<li class="item">
        <button class="grow item-name" title="How it looks" @click=${() => { app.select(`show/${i}`); app.open("look"); }}><span>${x.kind}</span><span class="quiet">of ${x.of}</span></button>
        <button class="small" ?disabled=${!s.may_edit} aria-label="Take ${textOf(x)} out of ${n.name}" @click=${() => app.session.edit([{ move: `show/${i}`, to: "" }])}>Take out</button></li>`,
    )}</ul>
    ${nodeEntries(app, s, n)}
  </section>`;
}

const textOf = (x: Shown): string => `${x.kind} of ${x.of}`;

const depthOf = (s: State, n: SceneNode): number => {
  const parent = s.scene.find((p) => p.name === n.in);
  return parent ? 1 + depthOf(s, parent) : 0;
};

/** A name that no node has yet. */
export function freeName(s: State, base: string): string {
  const taken = (name: string): boolean => s.scene.some((n) => n.name === name);
  let name = base;
  for (let i = 2; taken(name); i++) name = `${base}${i}`;
  return name;
}

/** A new node, at the top or in another one: for what is shown elsewhere, or for nothing yet. */
function addNode(app: App, s: State, parent: string): TemplateResult {
  const add = (value: string): void => {
    const show = s.show[Number(value)];
    const name = freeName(s, value !== "none" && show ? show.of : "group");
    const edits: Edit[] = [{ add: "node", name, in: parent, set: {} }];
    if (value !== "none" && show) edits.push({ move: `show/${value}`, to: name });
    app.session.edit(edits);
  };
  return chooser(s, parent ? `Add a node in ${parent}` : "Add a node", parent ? "+ node in it …" : "+ node …", add, (x) => x.in !== parent || parent === "", "for nothing yet");
}

function putHere(app: App, s: State, n: SceneNode): TemplateResult {
  return chooser(s, `Put into ${n.name}`, "+ put here …", (i) => app.session.edit([{ move: `show/${i}`, to: n.name }]), (x) => x.in !== n.name);
}

/** A list of what is shown, from which one is taken. */
function chooser(s: State, label: string, first: string, take: (value: string) => void, suits: (x: Shown) => boolean, none?: string): TemplateResult {
  return html`<select class="small" aria-label=${label} ?disabled=${!s.may_edit}
    @change=${(e: Event) => {
      const select = e.target as HTMLSelectElement;
      if (select.value) take(select.value);
      select.value = "";
    }}>
    <option value="">${first}</option>
    ${s.show.map((x, i) => (suits(x) ? html`<option value=${i}>${none ? "for " : ""}${textOf(x)}${x.in ? `, from ${x.in}` : ""}</option>` : nothing))}
    ${none ? html`<option value="none">${none}</option>` : nothing}
  </select>`;
}
