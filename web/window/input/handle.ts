// SPDX-License-Identifier: Apache-2.0
// Dragging a small thing: a handle in the picture, a point of a curve, an edge of a range.

export interface HandleDrag {
  /** Distance from where the drag began, in CSS pixels; `done` at its end. */
  move: (dx: number, dy: number, done: boolean, e: PointerEvent) => void;
  /** A press without movement. */
  click?: (e: PointerEvent) => void;
}

/** Begins a drag at a pointerdown; `begin` may decline by returning null. */
export function beginDrag(e: PointerEvent, begin: () => HandleDrag | null): void {
  if (e.button !== 0) return;
  const drag = begin();
  if (!drag) return;
  e.preventDefault();
  e.stopPropagation();
  const target = e.currentTarget as Element & { focus?: (o?: FocusOptions) => void };
  target.focus?.({ preventScroll: true });
  const [x, y] = [e.clientX, e.clientY];
  let moved = false;
  // The window hears the pointer wherever it goes, even when the handle is drawn anew under it.
  const move = (m: PointerEvent): void => {
    if (m.pointerId !== e.pointerId) return;
    moved ||= Math.hypot(m.clientX - x, m.clientY - y) > 2;
    if (moved) drag.move(m.clientX - x, m.clientY - y, false, m);
  };
  const end = (m: PointerEvent): void => {
    if (m.pointerId !== e.pointerId) return;
    window.removeEventListener("pointermove", move);
    window.removeEventListener("pointerup", end);
    window.removeEventListener("pointercancel", end);
    if (moved) drag.move(m.clientX - x, m.clientY - y, true, m);
    else if (m.type === "pointerup") drag.click?.(m);
  };
  window.addEventListener("pointermove", move);
  window.addEventListener("pointerup", end);
  window.addEventListener("pointercancel", end);
}
