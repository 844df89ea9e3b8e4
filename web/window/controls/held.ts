// SPDX-License-Identifier: Apache-2.0
// Sets the value of an input, unless somebody is typing in it: a redraw must not take away what is half written.
import { directive, Directive, type ElementPart, type PartInfo, PartType } from "lit/directive.js";

class Held extends Directive {
  constructor(info: PartInfo) {
    super(info);
    if (info.type !== PartType.ELEMENT) throw new Error("held() belongs into the tag of an input");
  }
  override update(part: ElementPart, [value]: [string]): void {
    const input = part.element as HTMLInputElement;
    if (document.activeElement === input && input.dataset.typing === "yes") return;
    if (input.value !== value) input.value = value;
  }
  render(_value: string): void {}
}

export const held = directive(Held);

/** Listeners that mark an input as being typed in, and hand over what was typed. */
export const typing = (e: Event): void => {
  (e.target as HTMLInputElement).dataset.typing = "yes";
};
export const typed = (e: Event): string => {
  const input = e.target as HTMLInputElement;
  input.dataset.typing = "no";
  return input.value;
};
