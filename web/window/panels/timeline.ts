// SPDX-License-Identifier: Apache-2.0
// The times of the data: play, step, speed, and the range that is played.
import { icon } from "../icons";
import { html, nothing, type TemplateResult } from "lit";
import { live } from "lit/directives/live.js";
import type { App } from "../app";
import { plain } from "../words";

export function timeline(app: App): TemplateResult | typeof nothing {
  const { player } = app;
  const n = player.times.length;
  if (n < 2) return nothing;
  const i = player.index;
  const whole = player.first === 0 && player.end === n - 1;
  return html`<div class="timeline" role="group" aria-label="Times">
    <button class="icon" aria-label="One time back" @click=${() => player.step(-1)}>${icon("back")}</button>
    <button class="icon primary" aria-label=${player.playing ? "Pause" : "Play"} @click=${() => player.toggle()}>${icon(player.playing ? "pause" : "play")}</button>
    <button class="icon" aria-label="One time on" @click=${() => player.step(1)}>${icon("on")}</button>
    <div class="track">
      <svg class="track-range" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true"><rect x=${(player.first / (n - 1)) * 100} width=${((player.end - player.first) / (n - 1)) * 100} height="6" /></svg>
      <input type="range" min="0" max=${n - 1} step="1" .value=${live(String(i))} aria-label="Time" aria-valuetext="${plain(player.times[i])}, ${i + 1} of ${n}"
        @input=${(e: Event) => { player.playing = false; player.go(Number((e.target as HTMLInputElement).value)); }} />
    </div>
    <span class="time-text">${plain(player.times[i])}<span class="quiet"> ${i + 1}/${n}</span></span>
    <button class="small" title="Play from here" @click=${() => { player.first = Math.min(i, player.end); app.changed(); }}>[ from</button>
    <button class="small" title="Play up to here" @click=${() => { player.last = Math.max(i, player.first); app.changed(); }}>to ]</button>
    ${whole ? nothing : html`<button class="icon small" aria-label="Play all times" @click=${() => { player.first = 0; player.last = Infinity; app.changed(); }}>${icon("reset")}</button>`}
    <label class="speed"><span class="hidden">Speed</span><select @change=${(e: Event) => { player.speed = Number((e.target as HTMLSelectElement).value); }}>
      ${[1, 2, 5, 10, 25].map((v) => html`<option value=${v} ?selected=${v === player.speed}>${v}/s</option>`)}</select></label>
    <label class="loop"><input type="checkbox" .checked=${player.loop} @change=${(e: Event) => { player.loop = (e.target as HTMLInputElement).checked; }} /> loop</label>
  </div>`;
}
