// SPDX-License-Identifier: Apache-2.0
// The program of a page.
import type { SceneInfo } from "./data/format";
import style from "./style.css?inline";
import { addControls } from "./ui/controls";
import { button, element } from "./ui/dom";
import { Editor } from "./ui/editor";
import { makeTimes } from "./ui/times";
import { makeAbout, makeToolbar } from "./ui/toolbar";
import { Viewer } from "./viewer";

const textOf = (id: string) => document.getElementById(id)?.textContent ?? "";

/** The small picture that the page carries, with the reason why it does not turn. */
function stayWithPicture(reason: string): void {
  document.querySelector(".stage")?.remove();
  document.body.append(element("p", { className: "sentence", textContent: reason, role: "status" }));
  document.documentElement.dataset.state = "picture";
}

async function start(): Promise<void> {
  document.head.append(element("style", { textContent: style }));
  const canvas = element("canvas", {}), over = element("canvas", {});
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, powerPreference: "high-performance" });
  if (!gl) return stayWithPicture("This browser has no WebGL2, or it is switched off: the picture does not turn here.");
  if (typeof DecompressionStream === "undefined") return stayWithPicture("This browser is too old to unpack the scene: the picture does not turn here.");
  const scene = JSON.parse(textOf("scene")) as SceneInfo;
  const stage = element("div", { className: "stage", tabIndex: 0, role: "application", ariaLabel: document.title }, canvas, over);
  document.body.append(stage);
  document.body.classList.toggle("timed", scene.steps.length > 1);
  const viewer = await Viewer.open(gl, canvas, over, scene, (n) => textOf(`a${n}`));
  canvas.addEventListener("webglcontextlost", () => stayWithPicture("The graphics card has given up this page: load it again."));

  const more: HTMLElement[] = [];
  let editor: Editor | null = null;
  if (viewer.step.volumes.length && viewer.step.volumes[0].info.mode !== "sum") {
    editor = new Editor(viewer);
    const made = editor;
    more.push(button("opacity", "The opacity of the volume (o)", () => { made.panel.hidden = !made.panel.hidden; }));
  }
  more.push(makeAbout(scene.notes, JSON.parse(textOf("recipe") || '""') as string));
  const tools = makeToolbar(viewer, document.title, more);
  document.body.append(tools.bar);
  if (editor) {
    const made = editor;
    document.body.append(made.panel);
    tools.keys.o = () => { made.panel.hidden = !made.panel.hidden; };
    viewer.onStep = () => made.paint();
  }
  if (scene.steps.length > 1) {
    const times = makeTimes(viewer);
    document.body.append(times.bar);
    tools.keys[" "] = times.play;
    const before = viewer.onStep;
    viewer.onStep = () => { before?.(), times.tell(); };
  }
  addControls(viewer, stage, tools.keys);
  new ResizeObserver(() => viewer.resize()).observe(stage);
  viewer.onStill = () => {
    document.getElementById("poster")?.remove();
    document.documentElement.dataset.state = "still";
  };
  // For programs that show a page inside theirs.
  Object.assign(window, { sightglass: { viewer, editor } });
}

start().catch((e: unknown) => stayWithPicture(`The scene cannot be shown: ${e instanceof Error ? e.message : String(e)}.`));
