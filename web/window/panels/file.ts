// SPDX-License-Identifier: Apache-2.0
// The tab of the session as a file: saved, loaded and compared, with the command that makes the same picture.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../app";
import { diff, download } from "../questions/files";
import { copy } from "../transfer/panel";

const ui: { mark: string | null; name: string; draft: string | null; problem: string } = { mark: null, name: "", draft: null, problem: "" };

export function filePanel(app: App): TemplateResult {
  const s = app.state;
  if (!s) return html``;
  // Compared with the beginning of the session, until a file is chosen.
  const lines = diff(ui.mark ?? app.beginning, s.pipeline);
  const changed = lines.some((l) => l.mark !== " ");
  const base = (s.title || "session").split(".")[0];
  return html`
    <section><h2>Session</h2>
      <div class="row wrap">
        <button class="small" @click=${() => download(`${base}.yaml`, "application/yaml", s.pipeline)}>Save …</button>
        ${pick("Load …", (text, name) => void load(app, text, name), !s.may_edit)}
        ${pick("Compare with …", (text, name) => { ui.mark = text; ui.name = name; app.changed(); })}
      </div>
      ${ui.problem ? html`<p class="problem" role="alert">${ui.problem}</p>` : nothing}
      ${ui.draft === null
        ? html`<pre class="code" tabindex="0" aria-label="The pipeline file">${s.pipeline}</pre>
          <div class="row"><button class="small" @click=${() => void copy(app, s.pipeline)}>Copy</button><button class="small" ?disabled=${!s.may_edit} @click=${() => { ui.draft = s.pipeline; app.changed(); }}>Edit as text</button></div>`
        : html`<textarea class="code" rows="14" spellcheck="false" aria-label="The pipeline file" .value=${ui.draft} @input=${(e: Event) => { ui.draft = (e.target as HTMLTextAreaElement).value; }}></textarea>
          <div class="row"><button class="small primary" @click=${() => void load(app, ui.draft ?? "", "the text")}>Apply</button><button class="small" @click=${() => { ui.draft = null; ui.problem = ""; app.changed(); }}>Cancel</button></div>`}
    </section>
    <section><h2>Changes ${ui.name ? `since ${ui.name}` : "in this session"}</h2>
      ${changed
        ? html`<pre class="code diff" tabindex="0" aria-label="Changes">${lines.filter((l) => l.mark !== " ").map((l) => html`<span class=${l.mark === "+" ? "plus" : "minus"}>${l.mark} ${l.text}
</span>`)}</pre>`
        : html`<p class="quiet">None.</p>`}
    </section>
    <section><h2>Command</h2>
      ${s.command
        ? html`<p class="code" tabindex="0" aria-label="The command">${s.command}</p><div class="row"><button class="small" @click=${() => void copy(app, s.command)}>Copy</button></div>`
        : html`<p class="quiet">This pipeline forks; save it and use <code>sightglass run</code>.</p>`}
    </section>
    ${s.notes.length + app.session.notes.length > 0
      ? html`<section><h2>Notes</h2><ul class="notes">${[...s.notes, ...app.session.notes].map((n) => html`<li>${n}</li>`)}</ul></section>`
      : nothing}`;
}

function pick(label: string, use: (text: string, name: string) => void, disabled = false): TemplateResult {
  return html`<label class="button small ${disabled ? "disabled" : ""}">${label}<input type="file" class="hidden" accept=".yaml,.yml" ?disabled=${disabled}
    @change=${async (e: Event) => {
      const input = e.target as HTMLInputElement;
      const file = input.files?.[0];
      if (file) use(await file.text(), file.name);
      input.value = "";
    }} /></label>`;
}

async function load(app: App, text: string, name: string): Promise<void> {
  try {
    await app.session.load(text);
    ui.problem = "";
    ui.draft = null;
    app.say(`Loaded ${name}`);
  } catch (error) {
    ui.problem = (error as Error).message;
  }
  app.changed();
}
