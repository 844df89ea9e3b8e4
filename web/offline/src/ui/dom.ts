// SPDX-License-Identifier: Apache-2.0
export function element<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Partial<HTMLElementTagNameMap[K]> = {}, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
}
export const button = (label: string, title: string, onclick: () => void) => element("button", { type: "button", textContent: label, title, onclick, ariaLabel: title });
