// SPDX-License-Identifier: Apache-2.0
// Colour scales as textures, and values as shaders take them.
import type { ArrayStore } from "../data/arrays";
import type { ScaleInfo } from "../data/format";
import { decodeSrgb } from "../data/srgb";
import { floatTable, type GL, type Program } from "./gl";

export const noValue = 3e38;

export class Scale {
  readonly texture: WebGLTexture;
  /** Linear RGB of even positions, three numbers each. */
  readonly linear: Float32Array;
  private readonly ends: [number, number];

  constructor(gl: GL, readonly info: ScaleInfo, srgb: ArrayLike<number>) {
    this.linear = new Float32Array(srgb.length);
    for (let i = 0; i < srgb.length; ++i) this.linear[i] = decodeSrgb(srgb[i] / 65535);
    const rgba = new Float32Array((srgb.length / 3) * 4);
    for (let i = 0; i < srgb.length / 3; ++i) {
      for (let k = 0; k < 3; ++k) rgba[4 * i + k] = this.linear[3 * i + k];
      rgba[4 * i + 3] = 1;
    }
    this.texture = floatTable(gl, rgba);
    this.ends = info.kind === "log" ? [0, Math.log(info.hi / info.lo)] : info.kind === "symlog" ? [symlog(info.lo / info.threshold), symlog(info.hi / info.threshold)] : [0, 1];
  }

  /** What shaders interpolate for a position on the scale. */
  stored(t: number): number {
    if (!(t === t)) return noValue;
    if (this.info.labels.length || this.info.kind === "linear") return t;
    const y = this.ends[0] + t * (this.ends[1] - this.ends[0]);
    return this.info.kind === "log" ? Math.exp(Math.min(y, 85)) : unSymlog(y);
  }
  /** Position of a value; NaN for none. */
  position(v: number): number {
    const s = this.info;
    if (s.labels.length) {
      const at = s.labels.findIndex((l) => Math.fround(l) === Math.fround(v));
      return at < 0 ? NaN : (at + 0.5) / s.labels.length;
    }
    if (s.lo === s.hi) return v === s.lo ? 0.5 : v < s.lo ? -1 : 2;
    if (s.kind === "log") return v > 0 ? Math.log(v / s.lo) / Math.log(s.hi / s.lo) : s.lo <= s.hi ? -1 : 2;
    if (s.kind === "symlog") return (symlog(v / s.threshold) - this.ends[0]) / (this.ends[1] - this.ends[0]);
    return (v - s.lo) / (s.hi - s.lo);
  }
  /** The value at a position. */
  value(t: number): number {
    const s = this.info;
    if (s.labels.length) return s.labels[Math.min(s.labels.length - 1, Math.max(0, Math.floor(t * s.labels.length)))];
    if (s.kind === "log") return s.lo * (s.hi / s.lo) ** t;
    if (s.kind === "symlog") return s.threshold * unSymlog(this.ends[0] + t * (this.ends[1] - this.ends[0]));
    return s.lo * (1 - t) + s.hi * t;
  }
  /** Linear RGBA. */
  color(v: number): ArrayLike<number> {
    const t = this.position(v), n = this.info.size;
    if (!(t === t)) return this.info.nan;
    if (t < 0) return this.info.below;
    if (t > 1) return this.info.above;
    const i = 3 * Math.floor(t * (n - 1) + 0.5);
    return [this.linear[i], this.linear[i + 1], this.linear[i + 2], 1];
  }
  bind(p: Program, unit: number): void {
    const s = this.info;
    p.texture("uTable", unit, this.texture);
    p.i("uTableSize", s.size);
    p.i("uScaleKind", s.labels.length || s.kind === "linear" ? 0 : s.kind === "log" ? 1 : 2);
    p.f("uScaleEnds", ...this.ends);
    p.f("uBelow", ...s.below), p.f("uAbove", ...s.above), p.f("uNan", ...s.nan);
  }
}

const symlog = (x: number) => (Math.abs(x) <= 1 ? x : Math.sign(x) * (1 + Math.log10(Math.abs(x))));
const unSymlog = (y: number) => (Math.abs(y) <= 1 ? y : Math.sign(y) * 10 ** (Math.abs(y) - 1));

export async function loadScales(gl: GL, infos: ScaleInfo[], store: ArrayStore): Promise<Scale[]> {
  return Promise.all(infos.map(async (info) => new Scale(gl, info, await store.get(info.colors))));
}
