// SPDX-License-Identifier: Apache-2.0
// The canvas of a view: decodes pictures and draws them over all of it, the newest only.
import type { FrameHeader } from "../protocol";
import type { Drawing } from "./drawing";

export class Canvas {
  private readonly context: CanvasRenderingContext2D;

  constructor(
    readonly element: HTMLCanvasElement,
    private readonly drawing: Drawing,
    private readonly shown: (frame: FrameHeader, drawn: boolean) => void,
  ) {
    this.context = element.getContext("2d", { alpha: false })!;
  }

  /** Gives the canvas as many pixels as the screen has; says whether that changed. */
  resize(width: number, height: number): boolean {
    const e = this.element;
    if (e.width === width && e.height === height) return false;
    // The old picture stays, stretched, until one of the new size comes.
    const old = e.width > 0 && e.height > 0 ? copyOf(e) : null;
    e.width = width;
    e.height = height;
    if (old) this.context.drawImage(old, 0, 0, width, height);
    return true;
  }

  async receive(frame: FrameHeader, picture: Uint8Array): Promise<void> {
    if (!this.drawing.fresh(frame)) return this.shown(frame, false);
    let bitmap: ImageBitmap;
    try {
      bitmap = await createImageBitmap(new Blob([picture as BlobPart], { type: frame.type }));
    } catch {
      return this.shown(frame, false);
    }
    // While this one was decoded, a newer one may have been drawn.
    const draw = this.drawing.fresh(frame);
    if (draw) {
      this.context.imageSmoothingEnabled = true;
      this.context.imageSmoothingQuality = "high";
      const e = this.element;
      const [x, y, width, height] = frame.part && frame.area ? frame.area : [0, 0, ...frame.of];
      const across = e.width / frame.of[0], down = e.height / frame.of[1];
      this.context.drawImage(bitmap, x * across, y * down, width * across, height * down);
      this.drawing.show(frame);
    }
    bitmap.close();
    this.shown(frame, draw);
  }
}

function copyOf(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  copy.getContext("2d")!.drawImage(canvas, 0, 0);
  return copy;
}
