// SPDX-License-Identifier: Apache-2.0
// Segments of constant width on the picture, as src/render/raster/marks draws them: round ends, a little nearer than they are, lit by their
// tangents, with halos. Ends may lie relative to a place of their own, in pixels (lines of glyphs).
import type { ArrayStore } from "../data/arrays";
import type { LinesInfo, Triple } from "../data/format";
import { positionsOf } from "../data/unpack";
import { cameraChunk, colorChunk, lightChunk, peelChunk, scaleChunk } from "./chunks";
import { Coloring } from "./coloring";
import { attribute, type GL, Program } from "./gl";
import { bindPass, type Drawable, drawMarks, type Pass } from "./pass";
import type { Scale } from "./scales";

const vertex = `
layout(location=0) in vec3 aFrom;
layout(location=1) in vec3 aTo;
layout(location=2) in vec2 aValues;
layout(location=3) in vec4 aColorFrom;
layout(location=4) in vec4 aColorTo;
layout(location=5) in vec3 aTangentFrom;
layout(location=6) in vec3 aTangentTo;
layout(location=7) in float aRoom;
layout(location=8) in vec3 aPlace;
${cameraChunk}${colorChunk}
uniform float uHalf, uHalo, uWholeFade;
uniform bool uInPixels, uRoomy;
flat out vec3 fA, fB, fFrom, fTo, fTangentFrom, fTangentTo;
flat out vec2 fValues, fPart;
flat out vec4 fColorFrom, fColorTo;
flat out float fFade;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float unit = 1.0;
  if (uInPixels) { float z = toEye(aPlace).z; unit = uSamples * (uParallel ? 1.0 : z) / uScale; }
  vec3 from = aPlace + aFrom * unit, to = aPlace + aTo * unit;
  vec3 a = toEye(from), b = toEye(to);
  fFrom = from, fTo = to, fTangentFrom = aTangentFrom, fTangentTo = aTangentTo, fValues = aValues;
  fColorFrom = vec4(fromSrgb(aColorFrom.rgb), aColorFrom.a), fColorTo = vec4(fromSrgb(aColorTo.rgb), aColorTo.a);
  fFade = 1.0;
  if (uRoomy) {
    float depth = 0.5 * (a.z + b.z), pixels = aRoom * (uParallel ? uScale : uScale / max(depth, 1e-30)) / uSamples;
    fFade = clamp((pixels - 3.0) / 5.0, 0.0, 1.0) * uWholeFade;
    if (!(fFade > 0.0)) return;
  }
  if (a.z < uNear && b.z < uNear) return;
  fPart = vec2(0.0, 1.0);
  if (a.z < uNear) { fPart.x = (uNear - a.z) / (b.z - a.z); a = mix(a, b, fPart.x); }
  else if (b.z < uNear) { fPart.y = (uNear - a.z) / (b.z - a.z); b = mix(a, b, fPart.y); }
  float sa = uParallel ? uScale : uScale / a.z, sb = uParallel ? uScale : uScale / b.z;
  fA = vec3(0.5 * uSize + sa * a.xy, uParallel ? a.z : 1.0 / a.z), fB = vec3(0.5 * uSize + sb * b.xy, uParallel ? b.z : 1.0 / b.z);
  vec2 along = fB.xy - fA.xy;
  float l = length(along), r = uHalf + uHalo + 1.0;
  along = l > 1e-6 ? along / l : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  bool end = (gl_VertexID & 1) == 1, side = (gl_VertexID & 2) == 2;
  vec2 p = (end ? fB.xy + along * r : fA.xy - along * r) + across * (side ? r : -r);
  gl_Position = vec4(p / (0.5 * uSize) - 1.0, 0.0, 1.0);
}`;

const fragment = `
flat in vec3 fA, fB, fFrom, fTo, fTangentFrom, fTangentTo;
flat in vec2 fValues, fPart;
flat in vec4 fColorFrom, fColorTo;
flat in float fFade;
uniform float uHalf, uHalo;
uniform vec3 uHaloColor;
uniform bool uLit, uNearest;
uniform int uContrast, uSoft;
${cameraChunk}${lightChunk}${scaleChunk}${colorChunk}${peelChunk}
out vec4 oColor;
/* A thin cylinder (src/render/shade/illuminated.h). */
vec2 lineLight(vec3 tangent, vec3 view) {
  float vt = clamp(dot(view, tangent), -1.0, 1.0), vAcross = sqrt(1.0 - vt * vt);
  vec3 v = view - tangent * vt;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < uLampCount; ++i) {
    vec3 to = uLamps[i].xyz, h = to + view;
    float lt = clamp(dot(to, tangent), -1.0, 1.0), across = sqrt(1.0 - lt * lt);
    float cosine = across * vAcross > 1e-6 ? clamp(dot(to - tangent * lt, v) / (across * vAcross), -1.0, 1.0) : 1.0;
    float angle = acos(cosine), ht = dot(h, tangent) / max(length(h), 1e-9), hAcross = sqrt(max(0.0, 1.0 - ht * ht));
    sum += uLamps[i].w * vec2(across * (sin(angle) + (3.14159265 - angle) * cosine) / 3.14159265, sqrt(0.5 * (1.0 + cosine)) * pow(hAcross, uMaterial.w));
  }
  return vec2(uMaterial.x + uMaterial.y * sum.x, uMaterial.z * sum.y);
}
void main() {
  vec2 q = gl_FragCoord.xy - fA.xy, d = fB.xy - fA.xy;
  float l2 = dot(d, d), t = l2 > 0.0 ? clamp(dot(q, d) / l2, 0.0, 1.0) : 0.0, distance = length(q - t * d);
  /* Of a pixel as wide as the line's own direction across it; 0: whole samples, 1: those that are covered, 2: the others. */
  float share = 1.0;
  if (uSoft == 0 ? distance > uHalf + uHalo : distance > uHalf + uHalo + 0.5) discard;
  if (uSoft != 0) {
    float wide = distance >= uHalf + 0.5 || uHalo == 0.0 ? uHalf + uHalo : uHalf;
    share = clamp(min(distance + 0.5, wide) - max(distance - 0.5, -wide), 0.0, 1.0);
    if ((share >= 0.999) != (uSoft == 1)) discard;
  }
  float w = mix(fA.z, fB.z, t), z = uParallel ? w : 1.0 / w, nearer = 2.0 * (uHalf + 1.0) / uScale;
  float front = uParallel ? z - nearer : z * (1.0 - nearer);
  bool halo = distance > (uSoft == 0 ? uHalf : uHalf + 0.5);
  if (uHalo == 0.0) halo = false;
  if (halo) front = max(front, 0.0) + 2.0 * (uHalf + distance) / uScale * (uParallel ? 1.0 : z);
  gl_FragDepth = toDepth(front);
  if (peeledAway(gl_FragDepth)) discard;
  float s = mix(fPart.x, fPart.y, uParallel ? t : t * fB.z / w);
  vec4 color = uConstant;
  if (uColoring == 1) {
    float v = uNearest ? (s < 0.5 ? fValues.x : fValues.y) : fValues.x == fValues.y ? fValues.x : mix(fValues.x, fValues.y, s);
    color = scaleColor(v);
  }
  if (uColoring == 2) color = mix(fColorFrom, fColorTo, s);
  vec2 light = vec2(1.0, 0.0);
  if (halo) color.rgb = uHaloColor;
  else if (uLit) {
    vec3 tangent = mix(fTangentFrom, fTangentTo, s);
    light = lineLight(normalize(tangent), toViewer(mix(fFrom, fTo, s)));
  }
  color.a *= uOpacity * fFade * share;
  if (!(color.a > 0.0)) discard;
  if (uContrast == 1) { oColor = vec4(0.0, 0.0, 0.0, 0.75 * color.a); return; }
  if (uContrast == 2) { oColor = vec4(vec3(0.1), 0.1) * color.a; return; }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`;

let program: Program | null = null;
export const lineProgram = (gl: GL) => (program ??= new Program(gl, vertex, fragment));

/** Ends of segments and all that goes with them, ready to be drawn. */
export interface Segments {
  from: Float32Array;
  to: Float32Array;
  values?: Float32Array;      // two a segment
  colorsFrom?: Uint8Array;
  colorsTo?: Uint8Array;
  tangentsFrom?: Float32Array;
  tangentsTo?: Float32Array;
  room?: Float32Array;
  places?: Float32Array;
}
export interface LineLook {
  width: number;
  opacity: number;
  lit: boolean;
  material: [number, number, number, number];
  contrast: "none" | "darker" | "lighter";
  halo: number;
  haloColor: Triple;
  inPixels: boolean;
}

export class Lines implements Drawable {
  readonly translucent: boolean;
  readonly opacity: number;
  readonly stage: "edges" | "marks";
  private readonly list: WebGLVertexArrayObject;
  private readonly count: number;

  constructor(private readonly gl: GL, private readonly look: LineLook, private readonly coloring: Coloring, private readonly s: Segments) {
    this.count = s.from.length / 3;
    this.translucent = look.opacity < 1, this.opacity = look.opacity;
    this.stage = s.room && !this.translucent ? "edges" : "marks";
    this.list = gl.createVertexArray()!;
    gl.bindVertexArray(this.list);
    const give = (at: number, data: Float32Array | undefined, size: number) => data && attribute(gl, at, data as Float32Array<ArrayBuffer>, size, 1);
    give(0, s.from, 3), give(1, s.to, 3), give(2, s.values, 2), give(5, s.tangentsFrom, 3), give(6, s.tangentsTo, 3), give(7, s.room, 1), give(8, s.places, 3);
    if (s.colorsFrom) attribute(gl, 3, s.colorsFrom as Uint8Array<ArrayBuffer>, 4, 1, gl.UNSIGNED_BYTE, true);
    if (s.colorsTo) attribute(gl, 4, s.colorsTo as Uint8Array<ArrayBuffer>, 4, 1, gl.UNSIGNED_BYTE, true);
    gl.bindVertexArray(null);
  }

  draw(pass: Pass): void {
    const gl = this.gl, p = lineProgram(gl), look = this.look;
    const edges = this.stage === "edges", fade = edges ? this.wholeFade(pass) : 1;
    if (!(fade > 0)) return;
    p.use();
    bindPass(p, pass);
    this.coloring.bind(p, 0, look.opacity);
    p.f("uMaterial", ...look.material);
    p.f("uHalf", Math.max(0.5, 0.5 * look.width * pass.samples)), p.f("uHalo", look.halo * pass.samples), p.f("uHaloColor", ...look.haloColor);
    p.f("uWholeFade", fade);
    p.i("uLit", look.lit ? 1 : 0), p.i("uNearest", this.coloring.nearest ? 1 : 0), p.i("uInPixels", look.inPixels ? 1 : 0), p.i("uRoomy", this.s.room ? 1 : 0);
    p.i("uContrast", pass.peel || look.contrast === "none" ? 0 : look.contrast === "darker" ? 1 : 2);
    if (edges) {  // each place once, however many segments meet there
      gl.enable(gl.BLEND), gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.enable(gl.STENCIL_TEST), gl.stencilFunc(gl.EQUAL, 0, 255), gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
      gl.depthMask(false);
    }
    gl.bindVertexArray(this.list);
    drawMarks(p, pass, edges || this.translucent, () => gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count));
    gl.bindVertexArray(null);
    if (edges) gl.disable(gl.BLEND), gl.disable(gl.STENCIL_TEST), gl.depthMask(true);
  }

  /** Edges of the larger cells alone would look like a change of the data: where many of small ones are gone, all go. */
  private wholeFade(pass: Pass): number {
    const { from, to, room } = this.s, p = pass.projection, step = Math.max(1, Math.floor(this.count / 4000));
    let gone = 0, there = 0;
    for (let i = 0; i < this.count; i += step) {
      const z = [0, 1].map((e) => {
        const q = e ? to : from;
        return [0, 1, 2].reduce((sum, a) => sum + (q[3 * i + a] + pass.center[a] - p.eye[a]) * p.forward[a], 0);
      });
      const pixel = (p.parallel ? p.scale : p.scale / Math.max(0.5 * (z[0] + z[1]), 1e-30)) / pass.samples;
      const length = Math.hypot(to[3 * i] - from[3 * i], to[3 * i + 1] - from[3 * i + 1], to[3 * i + 2] - from[3 * i + 2]);
      if (room![i] * pixel > 3) ++there;
      else if (length * pixel < 8) ++gone;
    }
    const share = gone / Math.max(1, gone + there);
    return Math.min(1, Math.max(0, (0.5 - share) / 0.25));
  }
}

/** Between the tangents at the ends of each segment, which are the means of the segments that meet there. */
function tangents(places: Float32Array, ends: Uint32Array): [Float32Array, Float32Array] {
  const n = ends.length / 2, own = new Float32Array(3 * n), from = new Float32Array(3 * n), to = new Float32Array(3 * n);
  const setUnit = (out: Float32Array, i: number, x: number, y: number, z: number) => {
    const l = Math.hypot(x, y, z) || 1;
    out[3 * i] = x / l, out[3 * i + 1] = y / l, out[3 * i + 2] = z / l;
  };
  for (let i = 0; i < n; ++i) {
    const a = 3 * ends[2 * i], b = 3 * ends[2 * i + 1];
    setUnit(own, i, places[b] - places[a], places[b + 1] - places[a + 1], places[b + 2] - places[a + 2]);
  }
  for (let i = 0; i < n; ++i) {
    const before = i > 0 && ends[2 * i - 1] === ends[2 * i] ? i - 1 : i, after = i + 1 < n && ends[2 * i + 1] === ends[2 * i + 2] ? i + 1 : i;
    setUnit(from, i, own[3 * before] + own[3 * i], own[3 * before + 1] + own[3 * i + 1], own[3 * before + 2] + own[3 * i + 2]);
    setUnit(to, i, own[3 * after] + own[3 * i], own[3 * after + 1] + own[3 * i + 1], own[3 * after + 2] + own[3 * i + 2]);
  }
  return [from, to];
}

export async function loadLines(gl: GL, info: LinesInfo, center: Triple, scales: Scale[], store: ArrayStore): Promise<Lines> {
  const coloring = await Coloring.load(info.color, scales, store);
  const places = await positionsOf(info.positions, center, store), ends = (await store.get(info.segments)) as Uint32Array, n = ends.length / 2;
  const s: Segments = { from: new Float32Array(3 * n), to: new Float32Array(3 * n) };
  for (let i = 0; i < n; ++i)
    for (let a = 0; a < 3; ++a) s.from[3 * i + a] = places[3 * ends[2 * i] + a], s.to[3 * i + a] = places[3 * ends[2 * i + 1] + a];
  const which = (i: number, end: number) => (coloring.perCell ? i : ends[2 * i + end]);
  if (coloring.values) s.values = Float32Array.from({ length: 2 * n }, (_, i) => coloring.values![which(i >> 1, i & 1)]);
  if (coloring.colors) {
    s.colorsFrom = new Uint8Array(4 * n), s.colorsTo = new Uint8Array(4 * n);
    for (let i = 0; i < n; ++i)
      for (let k = 0; k < 4; ++k) s.colorsFrom[4 * i + k] = coloring.colors[4 * which(i, 0) + k], s.colorsTo[4 * i + k] = coloring.colors[4 * which(i, 1) + k];
  }
  if (info.lit) [s.tangentsFrom, s.tangentsTo] = tangents(places, ends);
  if (info.room !== undefined) s.room = (await store.get(info.room)) as Float32Array;
  return new Lines(gl, { width: info.width, opacity: info.opacity, lit: info.lit, material: info.material, contrast: info.contrast, halo: info.halo, haloColor: info.halo_color, inPixels: false }, coloring, s);
}
