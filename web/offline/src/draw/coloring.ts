// SPDX-License-Identifier: Apache-2.0
// Colours of an item: numbers per point or cell, and the uniforms that go with them.
import type { ArrayStore } from "../data/arrays";
import type { ColorInfo } from "../data/format";
import { scalePositions } from "../data/unpack";
import type { Program } from "./gl";
import type { Scale } from "./scales";

export class Coloring {
  /** Values as shaders take them, one a point or cell; else null. */
  values: Float32Array | null = null;
  /** sRGB and alpha, four bytes each; else null. */
  colors: Uint8Array | null = null;
  readonly perCell: boolean;
  readonly nearest: boolean;
  readonly scale: Scale | null;

  private constructor(private readonly info: ColorInfo, scales: Scale[]) {
    this.perCell = info.kind !== "constant" && info.per_cell;
    this.nearest = info.kind === "scale" && info.nearest;
    this.scale = info.kind === "scale" ? scales[info.scale] : null;
  }
  static async load(info: ColorInfo, scales: Scale[], store: ArrayStore): Promise<Coloring> {
    const c = new Coloring(info, scales);
    if (info.kind === "direct") c.colors = (await store.get(info.colors.array)) as Uint8Array;
    if (info.kind === "scale") {
      const t = scalePositions(await store.get(info.positions.array), info.positions.bits, info.positions.least, info.positions.most);
      c.values = Float32Array.from(t, (x) => c.scale!.stored(x));
    }
    return c;
  }
  bind(p: Program, unit: number, opacity: number): void {
    p.i("uColoring", this.values ? 1 : this.colors ? 2 : 0);
    p.f("uConstant", ...(this.info.kind === "constant" ? this.info.rgba : [1, 1, 1, 1]));
    p.f("uOpacity", opacity);
    if (this.scale) this.scale.bind(p, unit);
    else p.texture("uTable", unit, null);  // else what it was last may be what is drawn into
  }
}
