// SPDX-License-Identifier: Apache-2.0
// The files of a served folder, to choose one to open.
import { html, nothing, render, type TemplateResult } from "lit";
import iconUrl from "./icon.svg?url";
import { bytes } from "./words";

export interface Listing {
  folders: string[];
  files: { name: string; bytes: number; series?: number | null }[];
  more?: boolean;
}

/** Folders above a folder, each with its path: "a/b" gives a and a/b. */
export function trail(below: string): [name: string, path: string][] {
  const parts = below.split("/").filter(Boolean);
  return parts.map((name, i) => [name, parts.slice(0, i + 1).join("/")]);
}

export const join = (below: string, name: string): string => (below ? `${below}/${name}` : name);

export async function listing(below: string): Promise<Listing | null> {
  const answer = await fetch(`/files.json?below=${encodeURIComponent(below)}`, { credentials: "same-origin" });
  return answer.ok ? ((await answer.json()) as Listing) : null;
}

export async function chooser(root: HTMLElement): Promise<void> {
  root.replaceChildren();
  const go = async (below: string): Promise<void> => {
    const found = await listing(below);
    render(page(below, found, go), root);
    document.title = `${below || "Files"} – Sightglass`;
  };
  await go(new URLSearchParams(location.search).get("below") ?? "");
}

function page(below: string, found: Listing | null, go: (below: string) => Promise<void>): TemplateResult {
  const folder = (name: string, path: string): TemplateResult =>
    html`<a href="/?below=${encodeURIComponent(path)}" @click=${(e: MouseEvent) => {
      if (e.metaKey || e.ctrlKey || e.shiftKey) return;
      e.preventDefault();
      history.replaceState(null, "", `/?below=${encodeURIComponent(path)}`);
      void go(path);
    }}>${name}</a>`;
  return html`<div class="chooser">
    <header class="bar"><h1><img src=${iconUrl} alt="" width="20" height="20" /><span>Sightglass</span></h1></header>
    <main>
      <nav aria-label="Folders above">${folder("Files", "")}${trail(below).map(([name, path]) => html` / ${folder(name, path)}`)}</nav>
      ${found
        ? html`<ul class="file-list">
            ${found.folders.map((name) => html`<li>${folder(`${name}/`, join(below, name))}</li>`)}
            ${found.files.map((f) => html`<li><a href="/?open=${encodeURIComponent(join(below, f.name))}">${f.name}</a><span class="quiet">${Number(f.series) > 1 ? `series of ${Number(f.series)} · ` : ""}${f.bytes > 0 ? bytes(f.bytes) : "folder of data"}</span></li>`)}
          </ul>
          ${found.folders.length + found.files.length === 0 ? html`<p class="empty">Nothing here can be read.</p>` : nothing}
          ${found.more ? html`<p class="quiet">There is more than is listed.</p>` : nothing}`
        : html`<p class="empty">There is no such folder.</p>`}
    </main>
  </div>`;
}
