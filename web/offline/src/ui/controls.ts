// SPDX-License-Identifier: Apache-2.0
// Mouse, touch, wheel and keys. Drag turns; with the right or middle button, or shift, it shifts; the wheel and two fingers zoom.
import type { Viewer } from "../viewer";

export interface Keys {
  [key: string]: () => void;
}

export function addControls(v: Viewer, surface: HTMLElement, keys: Keys): void {
  const pointers = new Map<number, { x: number; y: number }>();
  const height = () => v.layout.area.height;
  surface.addEventListener("contextmenu", (e) => e.preventDefault());
  surface.addEventListener("pointerdown", (e) => {
    surface.setPointerCapture(e.pointerId);
    surface.focus();
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
  });
  const drop = (e: PointerEvent) => pointers.delete(e.pointerId);
  surface.addEventListener("pointerup", drop), surface.addEventListener("pointercancel", drop);
  surface.addEventListener("pointermove", (e) => {
    const last = pointers.get(e.pointerId);
    if (!last) return;
    const dx = e.clientX - last.x, dy = e.clientY - last.y;
    if (pointers.size === 1) {
      if (e.buttons & 6 || e.shiftKey) v.camera.pan(dx / height(), dy / height());
      else if (e.ctrlKey || e.metaKey) v.camera.roll((dx / height()) * Math.PI);
      else v.camera.turn((dx / height()) * Math.PI, (dy / height()) * Math.PI);
    } else if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== e.pointerId)![1];
      const before = Math.hypot(last.x - other.x, last.y - other.y), now = Math.hypot(e.clientX - other.x, e.clientY - other.y);
      if (before > 0 && now > 0) v.camera.zoom(now / before);
      v.camera.pan((0.5 * dx) / height(), (0.5 * dy) / height());
    }
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    v.draw(true);
  });
  surface.addEventListener("wheel", (e) => {
    e.preventDefault();
    v.camera.zoom(Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015)));
    v.draw(true);
  }, { passive: false });
  surface.addEventListener("keydown", (e) => {
    const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[e.key];
    if (arrow && e.shiftKey) v.camera.pan(0.05 * arrow[0], 0.05 * arrow[1]);
    else if (arrow) v.camera.turn(0.1 * arrow[0], 0.1 * arrow[1]);
    else if (e.key === "+" || e.key === "=") v.camera.zoom(1.1);
    else if (e.key === "-") v.camera.zoom(1 / 1.1);
    else if (keys[e.key] && !e.ctrlKey && !e.metaKey && !e.altKey) keys[e.key]();
    else return;
    e.preventDefault();
    v.draw(true);
  });
}
