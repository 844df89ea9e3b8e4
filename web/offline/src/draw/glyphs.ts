// SPDX-License-Identifier: Apache-2.0
// A few shapes, each drawn at many places with a matrix of its own.
import type { ArrayStore, Numbers } from "../data/arrays";
import type { GlyphsInfo, Triple } from "../data/format";
import { positionsOf } from "../data/unpack";
import { cameraChunk, colorChunk, lightChunk, peelChunk, scaleChunk } from "./chunks";
import { Coloring } from "./coloring";
import { attribute, type GL, Program } from "./gl";
import { Lines, type Segments } from "./lines";
import { bindPass, type Drawable, type Pass } from "./pass";
import type { Scale } from "./scales";
import { surfaceEnd } from "./surfaces";

const vertex = `
layout(location=0) in vec3 aPoint;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in vec3 aPlace;
layout(location=5) in vec3 aRow0;
layout(location=6) in vec3 aRow1;
layout(location=7) in vec3 aRow2;
${cameraChunk}${colorChunk}
uniform bool uInPixels;
out vec3 vPlace, vNormal;
flat out float fValue;
flat out vec4 fColor;
void main() {
  float unit = 1.0;
  if (uInPixels) unit = uSamples * (uParallel ? 1.0 : toEye(aPlace).z) / uScale;
  vPlace = aPlace + unit * vec3(dot(aRow0, aPoint), dot(aRow1, aPoint), dot(aRow2, aPoint));
  // Normals turn with the cofactors of the matrix.
  vNormal = vec3(dot(cross(aRow1, aRow2), aNormal), dot(cross(aRow2, aRow0), aNormal), dot(cross(aRow0, aRow1), aNormal));
  float l = length(vNormal);
  vNormal = l > 0.0 ? vNormal / l : aNormal;
  fValue = aValue, fColor = vec4(fromSrgb(aColor.rgb), aColor.a);
  gl_Position = toClip(toEye(vPlace));
}`;
const fragment = `
in vec3 vPlace, vNormal;
flat in float fValue;
flat in vec4 fColor;
${cameraChunk}${lightChunk}${scaleChunk}${colorChunk}${peelChunk}${surfaceEnd}
void main() {
  shadeSurface(vPlace, vNormal, uColoring == 1 ? scaleColor(fValue) : uColoring == 2 ? fColor : uConstant);
}`;

let program: Program | null = null;

/** Numbers of the instances that have a shape. */
function instancesOf(shape: number, choice: Numbers | null, count: number): Uint32Array {
  const list: number[] = [];
  for (let i = 0; i < count; ++i) if ((choice ? choice[i] : 0) === shape) list.push(i);
  return Uint32Array.from(list);
}

function picked<T extends Float32Array | Uint8Array>(from: T, which: Uint32Array, size: number): T {
  const out = new (from.constructor as new (n: number) => T)(which.length * size);
  which.forEach((n, i) => { for (let k = 0; k < size; ++k) out[size * i + k] = from[size * n + k]; });
  return out;
}

export class Glyphs implements Drawable {
  readonly stage = "surface";
  readonly translucent: boolean;
  readonly opacity: number;
  private readonly lists: { list: WebGLVertexArrayObject; corners: number; count: number }[] = [];

  private constructor(private readonly gl: GL, private readonly info: GlyphsInfo, private readonly coloring: Coloring) {
    this.translucent = info.translucent, this.opacity = info.opacity;
  }

  static async load(gl: GL, info: GlyphsInfo, center: Triple, scales: Scale[], store: ArrayStore): Promise<Drawable> {
    const coloring = await Coloring.load(info.color, scales, store);
    const places = await positionsOf(info.places, center, store), codes = await store.get(info.matrices), n = places.length / 3;
    const matrices = new Float32Array(codes.length);
    for (let i = 0; i < codes.length; ++i) matrices[i] = (codes[i] - 32767) * info.largest;
    const choice = info.choice !== undefined ? await store.get(info.choice) : null;
    const shapes = await Promise.all(info.shapes.map(async (s) => ({ points: (await store.get(s.positions)) as Float32Array, normals: s.normals !== undefined ? ((await store.get(s.normals)) as Float32Array) : null })));
    if (info.kind === "glyph_lines") return glyphLines(gl, info, coloring, places, matrices, shapes.map((s) => s.points), choice);
    const g = new Glyphs(gl, info, coloring);
    shapes.forEach((shape, k) => {
      const which = instancesOf(k, choice, n);
      if (which.length === 0 || shape.points.length === 0) return;
      const list = gl.createVertexArray()!, m = picked(matrices, which, 9);
      gl.bindVertexArray(list);
      attribute(gl, 0, shape.points as Float32Array<ArrayBuffer>, 3);
      if (shape.normals) attribute(gl, 1, shape.normals as Float32Array<ArrayBuffer>, 3);
      if (coloring.values) attribute(gl, 2, picked(coloring.values, which, 1) as Float32Array<ArrayBuffer>, 1, 1);
      if (coloring.colors) attribute(gl, 3, picked(coloring.colors, which, 4) as Uint8Array<ArrayBuffer>, 4, 1, gl.UNSIGNED_BYTE, true);
      attribute(gl, 4, picked(places, which, 3) as Float32Array<ArrayBuffer>, 3, 1);
      for (let r = 0; r < 3; ++r) attribute(gl, 5 + r, picked(m, Uint32Array.from(which, (_, i) => 3 * i + r), 3) as Float32Array<ArrayBuffer>, 3, 1);
      gl.bindVertexArray(null);
      g.lists.push({ list, corners: shape.points.length / 3, count: which.length });
    });
    return g;
  }

  draw(pass: Pass): void {
    const gl = this.gl, p = (program ??= new Program(gl, vertex, fragment));
    p.use();
    bindPass(p, pass);
    this.coloring.bind(p, 0, this.info.opacity);
    p.f("uMaterial", ...this.info.material);
    p.i("uLit", this.info.lit ? 1 : 0), p.i("uSmooth", 1), p.i("uInPixels", this.info.in_pixels ? 1 : 0);
    for (const { list, corners, count } of this.lists) {
      gl.bindVertexArray(list);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, corners, count);
    }
    gl.bindVertexArray(null);
  }
}

/** Every line of every glyph as a segment relative to its place. */
function glyphLines(gl: GL, info: GlyphsInfo, coloring: Coloring, places: Float32Array, m: Float32Array, shapes: Float32Array[], choice: Numbers | null): Lines {
  const n = places.length / 3;
  let count = 0;
  for (let i = 0; i < n; ++i) count += shapes[choice ? choice[i] : 0].length / 6;
  const s: Segments = { from: new Float32Array(3 * count), to: new Float32Array(3 * count), places: new Float32Array(3 * count) };
  if (coloring.values) s.values = new Float32Array(2 * count);
  if (coloring.colors) s.colorsFrom = new Uint8Array(4 * count), s.colorsTo = new Uint8Array(4 * count);
  let at = 0;
  for (let i = 0; i < n; ++i) {
    const shape = shapes[choice ? choice[i] : 0];
    for (let k = 0; k < shape.length / 6; ++k, ++at) {
      for (let r = 0; r < 3; ++r) {
        for (const [to, first] of [[s.from, 6 * k], [s.to, 6 * k + 3]] as const)
          to[3 * at + r] = [0, 1, 2].reduce((sum, c) => sum + m[9 * i + 3 * r + c] * shape[first + c], 0);
        s.places![3 * at + r] = places[3 * i + r];
      }
      if (s.values) s.values[2 * at] = s.values[2 * at + 1] = coloring.values![i];
      if (s.colorsFrom) for (const to of [s.colorsFrom, s.colorsTo!]) to.set(coloring.colors!.subarray(4 * i, 4 * i + 4), 4 * at);
    }
  }
  return new Lines(gl, { width: info.width, opacity: info.opacity, lit: false, material: info.material, contrast: "none", halo: 0, haloColor: [0, 0, 0], inPixels: info.in_pixels }, coloring, s);
}
