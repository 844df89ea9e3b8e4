// SPDX-License-Identifier: Apache-2.0
// Keys and what they do. The table is also what the help lists, so that the two agree.

export type Scope = "view" | "window";

export interface Key {
  keys: string[]; // as KeyboardEvent.key, modifiers before it: "Shift+ArrowLeft", "Control+z"
  action: string;
  says: string;
  scope: Scope; // in a view that has the focus, or anywhere but in text
}

const key = (scope: Scope, keys: string, action: string, says: string): Key => ({ scope, keys: keys.split(" "), action, says });

export const keys: Key[] = [
  key("view", "ArrowLeft", "turn-left", "Turn to the left"),
  key("view", "ArrowRight", "turn-right", "Turn to the right"),
  key("view", "ArrowUp", "turn-up", "Turn upwards"),
  key("view", "ArrowDown", "turn-down", "Turn downwards"),
  key("view", "Shift+ArrowLeft", "pan-left", "Move to the left"),
  key("view", "Shift+ArrowRight", "pan-right", "Move to the right"),
  key("view", "Shift+ArrowUp", "pan-up", "Move upwards"),
  key("view", "Shift+ArrowDown", "pan-down", "Move downwards"),
  key("view", "+ =", "zoom-in", "Closer"),
  key("view", "- _", "zoom-out", "Farther"),
  key("view", "[", "roll-left", "Roll counter-clockwise"),
  key("view", "]", "roll-right", "Roll clockwise"),
  key("window", "1", "view-1", "From the front"),
  key("window", "2", "view-2", "From behind"),
  key("window", "3", "view-3", "From the left"),
  key("window", "4", "view-4", "From the right"),
  key("window", "5", "view-5", "From above"),
  key("window", "6", "view-6", "From below"),
  key("window", "7", "view-7", "From a corner"),
  key("window", "p", "projection", "Perspective or parallel"),
  key("window", "r", "reset", "The first view again"),
  key("window", "t", "tool-turn", "Tool: turn"),
  key("window", "m", "tool-pan", "Tool: move"),
  key("window", "w", "tool-window", "Tool: window and level"),
  key("window", "l", "tool-line", "Tool: plot over a line"),
  key("window", "d", "tool-measure", "Tool: measure distances, angles and areas"),
  key("window", "x", "tool-rectangle", "Tool: numbers in a rectangle of the picture"),
  key("window", "o", "tool-lasso", "Tool: numbers in an outline"),
  key("view", "Enter", "measure-middle", "Measure: a place in the middle of the picture"),
  key("window", "Backspace", "measure-back", "Measure: take the last place away"),
  key("window", "Escape", "measure-clear", "Measure: take all places away; numbers: the outline"),
  key("window", "f", "full-screen", "Full screen"),
  key("window", "b", "panel", "Show or hide the panel"),
  key("window", "a", "add", "Add an operation"),
  key("window", "s", "save", "Save the picture"),
  key("window", "Space", "play", "Play or pause the times"),
  key("window", ", <", "step-back", "One time back"),
  key("window", ". >", "step-on", "One time on"),
  key("window", "Control+z", "undo", "Undo"),
  key("window", "Control+y Control+Shift+z", "redo", "Redo"),
  key("window", "?", "help", "This help"),
];

/** The name of a pressed key with its modifiers. Shift is named only with keys that shift does not change by itself. */
export function nameOf(e: { key: string; ctrlKey: boolean; metaKey: boolean; shiftKey: boolean; altKey: boolean }): string {
  const control = e.ctrlKey || e.metaKey;
  const name = e.key === " " ? "Space" : e.key;
  const letter = name.length === 1 && /[a-z]/i.test(name);
  const shift = e.shiftKey && (name.length > 1 || (letter && control));
  return `${e.altKey ? "Alt+" : ""}${control ? "Control+" : ""}${shift ? "Shift+" : ""}${letter ? name.toLowerCase() : name}`;
}

export const actionOf = (name: string, inView: boolean): string | null =>
  keys.find((k) => k.keys.includes(name) && (k.scope === "window" || inView))?.action ?? null;

/** Whether a key belongs to the control that has the focus rather than to the window. */
export function isTyping(element: Element | null, name: string): boolean {
  if (!element) return false;
  if (element.matches("input:not([type=checkbox]):not([type=range]), textarea, select, [contenteditable]")) return true;
  if (name === "Space" || name === "Enter") return element.matches("button, input, summary, a, [role=button], [role=tab]");
  return element.matches("input[type=range]") && /^(Arrow|Home|End|Page)/.test(name);
}
