// SPDX-License-Identifier: Apache-2.0
// Time steps: a slider, and a button that plays them.
import type { Viewer } from "../viewer";
import { button, element } from "./dom";

const perSecond = 8;

export function makeTimes(v: Viewer): { bar: HTMLElement; play: () => void; tell: () => void } {
  const count = v.scene.steps.length;
  const slider = element("input", { type: "range", min: "0", max: String(count - 1), step: "1", value: "0", ariaLabel: "Time step" });
  const label = element("span", { className: "time" });
  let timer = 0;
  const tell = () => {
    const t = v.scene.steps[v.number].time;
    label.textContent = `${v.number + 1} of ${count}${t === undefined ? "" : `, t = ${Number(t.toPrecision(6))}`}`;
    slider.value = String(v.number);
  };
  const next = async () => {
    const start = performance.now();
    await v.show((v.number + 1) % count);
    if (timer) timer = window.setTimeout(next, Math.max(0, 1000 / perSecond - (performance.now() - start)));
  };
  const play = () => {
    if (timer) clearTimeout(timer), timer = 0;
    else timer = window.setTimeout(next, 0);
    go.textContent = timer ? "❚❚" : "►";
  };
  const go = button("►", "Play (space)", play);
  slider.oninput = () => void v.show(Number(slider.value));
  tell();
  return { bar: element("div", { className: "bar times" }, go, slider, label), play, tell };
}
