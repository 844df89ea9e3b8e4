// SPDX-License-Identifier: Apache-2.0
// Dark or light: as the system says, until somebody chooses.
import { icon } from "./icons";
import { html, type TemplateResult } from "lit";
import type { App } from "./app";

type Theme = "dark" | "light";
const key = "sightglass-theme";
const system = window.matchMedia("(prefers-color-scheme: dark)");

function chosen(): Theme | null {
  const t = localStorage.getItem(key);
  return t === "dark" || t === "light" ? t : null;
}

export const theme = (): Theme => chosen() ?? (system.matches ? "dark" : "light");

export function applyTheme(): void {
  document.documentElement.dataset.theme = theme();
}

export function followSystem(changed: () => void): void {
  applyTheme();
  system.addEventListener("change", () => {
    applyTheme();
    changed();
  });
}

export function themeButton(app: App): TemplateResult {
  const next: Theme = theme() === "dark" ? "light" : "dark";
  return html`<button class="icon" aria-label="${next === "dark" ? "Dark" : "Light"} theme" title="${next === "dark" ? "Dark" : "Light"} theme"
    @click=${() => {
      localStorage.setItem(key, next);
      applyTheme();
      app.changed();
    }}>${icon(next)}</button>`;
}
