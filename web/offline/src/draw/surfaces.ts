// SPDX-License-Identifier: Apache-2.0
// Triangles with smooth or face normals, coloured by points, cells or one colour, lit on both sides.
import type { ArrayStore } from "../data/arrays";
import type { SurfaceInfo, Triple } from "../data/format";
import { normalsOf, positionsOf } from "../data/unpack";
import { cameraChunk, colorChunk, lightChunk, peelChunk, scaleChunk } from "./chunks";
import { Coloring } from "./coloring";
import { attribute, type GL, Program } from "./gl";
import { bindPass, type Drawable, type Pass } from "./pass";
import type { Scale } from "./scales";

const vertex = `
layout(location=0) in vec3 aPlace;
layout(location=1) in vec3 aNormal;
layout(location=2) in float aValue;
layout(location=3) in vec4 aColor;
layout(location=4) in vec3 aValues;
${cameraChunk}${colorChunk}
out vec3 vPlace, vNormal, vValues, vCorner;
out float vValue;
out vec4 vColor;
void main() {
  vPlace = aPlace, vNormal = aNormal, vValue = aValue, vValues = aValues;
  vCorner = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
  vColor = vec4(fromSrgb(aColor.rgb), aColor.a);
  gl_Position = toClip(toEye(aPlace));
}`;

/** Ends of every shader of surfaces: from place, normal and colour to what is seen. */
export const surfaceEnd = `
uniform bool uLit, uSmooth;
out vec4 oColor;
void shadeSurface(vec3 place, vec3 normal, vec4 color) {
  color.a *= uOpacity;
  if (!(color.a > 0.0) || peeledAway(gl_FragCoord.z)) discard;
  vec2 light = vec2(1.0, 0.0);
  if (uLit) {
    vec3 view = toViewer(place), face = cross(dFdx(place), dFdy(place));
    float l = length(face);
    face = l > 0.0 ? face / l : view;
    if (dot(face, view) < 0.0) face = -face;
    vec3 n = face;
    if (uSmooth && dot(normal, normal) > 1e-20) {
      n = normalize(normal);
      if (dot(n, face) < 0.0) n = -n;
    }
    light = lightOn(n, view);
  }
  oColor = vec4((color.rgb * light.x + light.y) * color.a, color.a);
}`;

const fragment = `
in vec3 vPlace, vNormal, vValues, vCorner;
in float vValue;
in vec4 vColor;
uniform bool uNearest;
${cameraChunk}${lightChunk}${scaleChunk}${colorChunk}${peelChunk}${surfaceEnd}
void main() {
  vec4 color = uConstant;
  float value = vValue;
  if (uNearest) value = vCorner.x >= vCorner.y && vCorner.x >= vCorner.z ? vValues.x : vCorner.y >= vCorner.z ? vValues.y : vValues.z;
  if (uColoring == 1) color = scaleColor(value);
  if (uColoring == 2) color = vColor;
  shadeSurface(vPlace, vNormal, color);
}`;

let program: Program | null = null;
export const surfaceProgram = (gl: GL) => (program ??= new Program(gl, vertex, fragment));

function taken<T extends Float32Array | Uint8Array>(from: T, which: ArrayLike<number>, size: number): T {
  const out = new (from.constructor as new (n: number) => T)(which.length * size);
  for (let i = 0; i < which.length; ++i) for (let k = 0; k < size; ++k) out[size * i + k] = from[size * which[i] + k];
  return out;
}

export class Surface implements Drawable {
  readonly stage = "surface";
  readonly translucent: boolean;
  readonly opacity: number;
  private readonly list: WebGLVertexArrayObject;
  private count = 0;
  private indexed = false;
  private smooth = false;

  private constructor(private readonly gl: GL, private readonly info: SurfaceInfo, private readonly coloring: Coloring) {
    this.translucent = info.translucent, this.opacity = info.opacity;
    this.list = gl.createVertexArray()!;
  }

  static async load(gl: GL, info: SurfaceInfo, center: Triple, scales: Scale[], store: ArrayStore): Promise<Surface> {
    const coloring = await Coloring.load(info.color, scales, store), s = new Surface(gl, info, coloring);
    let places = await positionsOf(info.positions, center, store);
    const triangles = (await store.get(info.triangles)) as Uint32Array;
    let normals = info.normals ? await normalsOf(info.normals, store) : null;
    let values = coloring.values, colors = coloring.colors;
    const apart = info.corners !== undefined || coloring.perCell || coloring.nearest;
    let three: Float32Array | null = null;
    if (apart) {  // every corner on its own
      places = taken(places, triangles, 3);
      if (normals) normals = taken(normals, info.corners !== undefined ? await store.get(info.corners) : triangles, 3);
      const which = coloring.perCell ? Uint32Array.from(triangles, (_, i) => Math.floor(i / 3)) : triangles;
      if (values) values = taken(values, which, 1);
      if (colors) colors = taken(colors, which, 4);
      if (values && coloring.nearest) three = taken(values, Uint32Array.from({ length: 3 * values.length }, (_, i) => Math.floor(i / 9) * 3 + (i % 3)), 1);
    }
    gl.bindVertexArray(s.list);
    attribute(gl, 0, places as Float32Array<ArrayBuffer>, 3);
    if (normals) attribute(gl, 1, normals as Float32Array<ArrayBuffer>, 3);
    if (values) attribute(gl, 2, values as Float32Array<ArrayBuffer>, 1);
    if (colors) attribute(gl, 3, colors as Uint8Array<ArrayBuffer>, 4, 0, gl.UNSIGNED_BYTE, true);
    if (three) attribute(gl, 4, three as Float32Array<ArrayBuffer>, 3);
    if (!apart) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles as Uint32Array<ArrayBuffer>, gl.STATIC_DRAW);
    }
    gl.bindVertexArray(null);
    s.indexed = !apart, s.count = triangles.length, s.smooth = normals !== null;
    if (values) coloring.values = new Float32Array(0);  // it is on the graphics card; that it is coloured by values stays known
    if (colors) coloring.colors = new Uint8Array(0);
    return s;
  }

  draw(pass: Pass): void {
    const gl = this.gl, p = surfaceProgram(gl);
    p.use();
    bindPass(p, pass);
    this.coloring.bind(p, 0, this.info.opacity);
    p.f("uMaterial", ...this.info.material);
    p.i("uLit", this.info.lit ? 1 : 0), p.i("uSmooth", this.smooth ? 1 : 0), p.i("uNearest", this.coloring.nearest && !this.coloring.perCell ? 1 : 0);
    gl.bindVertexArray(this.list);
    if (this.indexed) gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(gl.TRIANGLES, 0, this.count);
    gl.bindVertexArray(null);
  }
}
