// SPDX-License-Identifier: Apache-2.0
// A dialog over the window: the browser's own, which holds the focus and closes with Escape.
import { icon } from "../icons";
import { html, type TemplateResult } from "lit";
import { ref } from "lit/directives/ref.js";
import type { App } from "../app";

export function dialog(app: App, name: string, content: TemplateResult, wide = false): TemplateResult {
  const close = (): void => {
    app.dialog = null;
    app.changed();
  };
  return html`<dialog class=${wide ? "wide" : ""} aria-label=${name} ${ref((e) => {
      const d = e as HTMLDialogElement | undefined;
      if (d && !d.open && d.isConnected) d.showModal();
      else if (d && !d.open) queueMicrotask(() => d.isConnected && !d.open && d.showModal());
    })}
    @close=${close} @click=${(e: MouseEvent) => e.target === e.currentTarget && close()}>
    <div class="dialog-body">
      <header class="row"><h2 class="grow">${name}</h2><button class="icon" aria-label="Close" @click=${close}>${icon("close")}</button></header>
      ${content}
    </div>
  </dialog>`;
}
