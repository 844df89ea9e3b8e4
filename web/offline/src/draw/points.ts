// SPDX-License-Identifier: Apache-2.0
// Points as dots or little spheres of constant size on the picture, or as discs of a size and direction in the world.
import type { ArrayStore } from "../data/arrays";
import type { PointsInfo, Triple } from "../data/format";
import { normalsOf, positionsOf } from "../data/unpack";
import { cameraChunk, colorChunk, lightChunk, peelChunk, scaleChunk } from "./chunks";
import { Coloring } from "./coloring";
import { attribute, type GL, Program } from "./gl";
import { bindPass, type Drawable, drawMarks, type Pass } from "./pass";
import type { Scale } from "./scales";

const vertex = `
layout(location=0) in vec3 aPlace;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in float aRadius;
${cameraChunk}${colorChunk}
uniform float uHalf;
uniform bool uDiscs;
out vec2 vAt;
flat out vec3 fNormal, fPlace;
flat out float fValue, fDepth;
flat out vec4 fColor;
out vec3 vPlace;
void main() {
  vec2 corner = vec2((gl_VertexID & 1) == 1 ? 1.0 : -1.0, (gl_VertexID & 2) == 2 ? 1.0 : -1.0);
  fValue = aValue, fColor = vec4(fromSrgb(aColor.rgb), aColor.a), fNormal = aNormal, fPlace = aPlace, vPlace = aPlace, fDepth = 0.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (uDiscs) {
    vec3 a = normalize(cross(aNormal, abs(aNormal.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0))), b = cross(aNormal, a);
    vPlace = aPlace + (a * corner.x + b * corner.y) * aRadius;
    vAt = corner;
    gl_Position = toClip(toEye(vPlace));
    return;
  }
  vec3 e = toEye(aPlace);
  if (e.z < uNear) return;
  float nearer = 2.0 * (uHalf + 1.0) / uScale, s = uParallel ? uScale : uScale / e.z, r = uHalf + 1.0;
  fDepth = toDepth(uParallel ? e.z - nearer : e.z * (1.0 - nearer));
  vAt = corner * r / uHalf;
  gl_Position = vec4((s * e.xy + corner * r) / (0.5 * uSize), 2.0 * fDepth - 1.0, 1.0);
}`;

const fragment = `
in vec2 vAt;
in vec3 vPlace;
flat in vec3 fNormal, fPlace;
flat in float fValue, fDepth;
flat in vec4 fColor;
uniform bool uDiscs, uLit;
uniform int uSoft;
uniform float uHalf;
${cameraChunk}${lightChunk}${scaleChunk}${colorChunk}${peelChunk}
out vec4 oColor;
void main() {
  float r2 = dot(vAt, vAt), share = 1.0;
  if (uDiscs || uSoft == 0) {
    if (r2 > 1.0) discard;
  } else {
    float distance = sqrt(r2) * uHalf;
    share = clamp(min(distance + 0.5, uHalf) - max(distance - 0.5, -uHalf), 0.0, 1.0);
    if (!(share > 0.0) || (share >= 0.999) != (uSoft == 1)) discard;
  }
  if (peeledAway(gl_FragCoord.z)) discard;
  vec4 color = uColoring == 1 ? scaleColor(fValue) : uColoring == 2 ? fColor : uConstant;
  color.a *= uOpacity * share;
  if (!(color.a > 0.0)) discard;
  vec2 light = vec2(1.0, 0.0);
  if (uDiscs) {
    vec3 view = toViewer(vPlace), n = fNormal;
    light = lightOn(dot(n, view) < 0.0 ? -n : n, view);
  } else if (uLit) {
    light = lightOn(normalize(uRight * vAt.x + uUp * vAt.y - uForward * sqrt(max(0.0, 1.0 - r2))), -uForward);
  }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`;

let program: Program | null = null;

export class Points implements Drawable {
  readonly stage = "marks";
  readonly translucent: boolean;
  readonly opacity: number;
  private count = 0;
  private readonly list: WebGLVertexArrayObject;

  private constructor(private readonly gl: GL, private readonly info: PointsInfo, private readonly coloring: Coloring) {
    this.translucent = info.opacity < 1, this.opacity = info.opacity;
    this.list = gl.createVertexArray()!;
  }
  static async load(gl: GL, info: PointsInfo, center: Triple, scales: Scale[], store: ArrayStore): Promise<Points> {
    const s = new Points(gl, info, await Coloring.load(info.color, scales, store));
    const places = await positionsOf(info.positions, center, store);
    const normals = info.normals ? await normalsOf(info.normals, store) : null, radii = info.radii !== undefined ? await store.get(info.radii) : null;
    gl.bindVertexArray(s.list);
    attribute(gl, 0, places as Float32Array<ArrayBuffer>, 3, 1);
    if (normals) attribute(gl, 1, normals as Float32Array<ArrayBuffer>, 3, 1);
    if (s.coloring.values) attribute(gl, 2, s.coloring.values as Float32Array<ArrayBuffer>, 1, 1);
    if (s.coloring.colors) attribute(gl, 3, s.coloring.colors as Uint8Array<ArrayBuffer>, 4, 1, gl.UNSIGNED_BYTE, true);
    if (radii) attribute(gl, 4, radii as Float32Array<ArrayBuffer>, 1, 1);
    gl.bindVertexArray(null);
    s.count = places.length / 3;
    return s;
  }
  draw(pass: Pass): void {
    const gl = this.gl, p = (program ??= new Program(gl, vertex, fragment));
    p.use();
    bindPass(p, pass);
    this.coloring.bind(p, 0, this.info.opacity);
    p.f("uMaterial", ...this.info.material);
    p.f("uHalf", Math.max(0.5, 0.5 * this.info.size * pass.samples));
    p.i("uDiscs", this.info.kind === "discs" ? 1 : 0), p.i("uLit", this.info.lit ? 1 : 0);
    gl.bindVertexArray(this.list);
    drawMarks(p, pass, this.translucent || this.info.kind === "discs", () => gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count));
    gl.bindVertexArray(null);
  }
}
