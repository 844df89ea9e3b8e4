// SPDX-License-Identifier: Apache-2.0
// Mouse, pen and touch on a view, told apart into clicks, drags and pinches. One finger or button drags with the tool that is chosen;
// two fingers pan, zoom and roll together.

export type Button = "left" | "middle" | "right";

export interface Drag {
  from: [number, number]; // CSS pixels in the view
  at: [number, number];
  moved: [number, number]; // since the last call
  button: Button;
  shift: boolean;
  control: boolean;
}

export interface PointerHandlers {
  begin: (drag: Drag) => void;
  drag: (drag: Drag) => void;
  end: (drag: Drag) => void;
  click: (at: [number, number], button: Button) => void;
  pinch: (by: { at: [number, number]; moved: [number, number]; factor: number; angle: number }) => void;
  wheel: (at: [number, number], factor: number) => void;
  hover: (at: [number, number] | null) => void;
}

/** A press that moves less than this many pixels is a click. */
const still = 4;

export function listen(element: HTMLElement, handlers: PointerHandlers): void {
  const pointers = new Map<number, [number, number]>();
  let drag: Drag | null = null;
  let begun = false;

  const place = (e: MouseEvent): [number, number] => {
    const box = element.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  };
  const onChrome = (e: Event): boolean => (e.target as Element).closest?.("[data-handle], button, input, select") !== null;

  element.addEventListener("pointerdown", (e) => {
    if (onChrome(e)) return;
    element.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, place(e));
    if (pointers.size > 1) {
      if (drag && begun) handlers.end(drag);
      drag = null;
      begun = false;
      return;
    }
    const button: Button = e.button === 1 ? "middle" : e.button === 2 ? "right" : "left";
    drag = { from: place(e), at: place(e), moved: [0, 0], button, shift: e.shiftKey, control: e.ctrlKey || e.metaKey };
    element.focus({ preventScroll: true });
  });

  element.addEventListener("pointermove", (e) => {
    const at = place(e);
    if (!pointers.has(e.pointerId)) {
      if (e.pointerType !== "touch") handlers.hover(onChrome(e) ? null : at);
      return;
    }
    if (pointers.size >= 2) {
      pinched(e.pointerId, at);
      return;
    }
    pointers.set(e.pointerId, at);
    if (!drag) return;
    const next: Drag = { ...drag, at, moved: [at[0] - drag.at[0], at[1] - drag.at[1]] };
    if (!begun) {
      if (Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) < still) return;
      begun = true;
      handlers.begin(drag);
    }
    drag = next;
    handlers.drag(next);
  });

  function pinched(id: number, at: [number, number]): void {
    const [a, b] = [...pointers.keys()];
    if (id !== a && id !== b) return;
    const before = [pointers.get(a)!, pointers.get(b)!];
    pointers.set(id, at);
    const after = [pointers.get(a)!, pointers.get(b)!];
    const middle = (p: [number, number][]): [number, number] => [(p[0][0] + p[1][0]) / 2, (p[0][1] + p[1][1]) / 2];
    const span = (p: [number, number][]): [number, number] => [p[1][0] - p[0][0], p[1][1] - p[0][1]];
    const m0 = middle(before);
    const m1 = middle(after);
    const s0 = span(before);
    const s1 = span(after);
    const factor = Math.hypot(...s1) / Math.max(Math.hypot(...s0), 1);
    const angle = Math.atan2(s0[0] * s1[1] - s0[1] * s1[0], s0[0] * s1[0] + s0[1] * s1[1]);
    handlers.pinch({ at: m1, moved: [m1[0] - m0[0], m1[1] - m0[1]], factor, angle });
  }

  const release = (e: PointerEvent): void => {
    if (!pointers.delete(e.pointerId)) return;
    if (pointers.size > 0 || !drag) return;
    if (begun) handlers.end(drag);
    else if (e.type === "pointerup") handlers.click(drag.at, drag.button);
    drag = null;
    begun = false;
  };
  element.addEventListener("pointerup", release);
  element.addEventListener("pointercancel", release);
  element.addEventListener("pointerleave", () => handlers.hover(null));
  element.addEventListener("contextmenu", (e) => {
    if (!onChrome(e)) e.preventDefault();
  });
  element.addEventListener(
    "wheel",
    (e) => {
      e.preventDefault();
      const lines = e.deltaMode === 1 ? 16 : e.deltaMode === 2 ? 100 : 1;
      handlers.wheel(place(e), Math.exp(-Math.max(-200, Math.min(200, e.deltaY * lines)) * (e.ctrlKey ? 0.01 : 0.0015)));
    },
    { passive: false },
  );
}
