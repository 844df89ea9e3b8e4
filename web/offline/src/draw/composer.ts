// SPDX-License-Identifier: Apache-2.0
// One picture: what is opaque by depth; layers of what is seen through, and the volumes between them, from the front; all of it in linear
// light over the background, and means over the samples of a pixel at the end.
import type { SceneInfo } from "../data/format";
import type { Volume } from "../volume/volume";
import { type GL, Program, Target } from "./gl";
import type { Drawable, Pass } from "./pass";

const triangle = `
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 1 ? 3.0 : -1.0, (gl_VertexID & 2) == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;
const copyText = `
uniform sampler2D uFrom;
out vec4 oColor;
void main() { oColor = texelFetch(uFrom, ivec2(gl_FragCoord.xy), 0); }`;
const resolveText = `
uniform sampler2D uFrom;
uniform vec4 uArea;       /* of the picture in the window, lower left corner and size */
uniform vec2 uWindow;
uniform float uSamples;   /* along an axis per pixel, a whole number */
uniform vec3 uBottom, uTop;
out vec4 oColor;
vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }
void main() {
  float row = uWindow.y > 1.5 ? (gl_FragCoord.y - 0.5) / (uWindow.y - 1.0) : 0.0;
  vec3 background = fromSrgb(mix(uBottom, uTop, clamp(row, 0.0, 1.0)));
  vec4 c = vec4(0.0);
  vec2 at = gl_FragCoord.xy - uArea.xy;
  if (all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, uArea.zw))) {
    int n = int(uSamples + 0.5);
    ivec2 first = ivec2(floor(at)) * n;
    for (int j = 0; j < n; ++j) for (int i = 0; i < n; ++i) c += min(texelFetch(uFrom, first + ivec2(i, j), 0), vec4(65000.0));
    c /= float(n * n);
  }
  oColor = vec4(toSrgb(min(c.rgb + (1.0 - c.a) * background, vec3(1.0))), 1.0);
}`;

export interface Area {
  x: number;  // pixels of the window; y from below
  y: number;
  width: number;
  height: number;
}

export interface Quality {
  /** Samples along an axis per pixel: a whole number, or below 1. */
  samples: number;
  /** Length of steps through volumes in those of the still picture. */
  coarse: number;
  layers: number;
}

export class Composer {
  private readonly copy: Program;
  private readonly resolve: Program;
  private readonly opaque: Target;
  private readonly layers: [Target, Target];
  private readonly sum: Target;
  private readonly format: number;

  constructor(private readonly gl: GL, private readonly scene: SceneInfo) {
    const half = gl.getExtension("EXT_color_buffer_float") || gl.getExtension("EXT_color_buffer_half_float");
    const format = this.format = half ? gl.RGBA16F : gl.SRGB8_ALPHA8;
    this.copy = new Program(gl, triangle, copyText), this.resolve = new Program(gl, triangle, resolveText);
    this.opaque = new Target(gl, format, true), this.sum = new Target(gl, format, false);
    this.layers = [new Target(gl, format, true), new Target(gl, format, true)];
  }

  /** How many layers of what is seen through lie one behind the other, at most `most`: from the sum of their opacities in a small picture. */
  layersOf(pass: Pass, drawables: Drawable[], most: number): number {
    const gl = this.gl, through = drawables.filter((d) => d.translucent), p = pass.projection;
    if (!through.length || this.format !== gl.RGBA16F) return through.length ? most : 0;
    const factor = Math.min(1, 240 / p.width), w = Math.max(1, Math.round(p.width * factor)), h = Math.max(1, Math.round(p.height * factor));
    const t = (this.counted ??= new Target(gl, gl.RGBA16F, false));
    t.resize(w, h);
    t.bind();
    gl.disable(gl.SCISSOR_TEST), gl.disable(gl.DEPTH_TEST), gl.clearColor(0, 0, 0, 0), gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND), gl.blendFunc(gl.ONE, gl.ONE);
    const small: Pass = { ...pass, projection: { ...p, width: w, height: h, scale: p.scale * factor }, samples: pass.samples * factor, peel: null, soft: false };
    for (const d of through) d.draw(small);
    gl.disable(gl.BLEND);
    const pixels = new Float32Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.FLOAT, pixels);
    let sum = 0;
    for (let i = 3; i < pixels.length; i += 4) sum = Math.max(sum, pixels[i]);
    const least = Math.max(1 / 64, Math.min(...through.map((d) => d.opacity)));
    return Math.min(most, Math.ceil(sum / least + 0.5));
  }
  private counted: Target | null = null;

  /** All of a picture, or the rows [first, last) of it alone. */
  draw(pass: Pass, drawables: Drawable[], volumes: Volume[], q: Quality, rows?: [number, number]): void {
    const gl = this.gl, w = pass.projection.width, h = pass.projection.height;
    const through = drawables.filter((d) => d.translucent);
    for (const t of [this.opaque, this.sum]) t.resize(w, h);
    if (through.length) for (const t of this.layers) t.resize(w, h);
    gl.enable(gl.SCISSOR_TEST);
    const [first, last] = rows ?? [0, h];
    gl.scissor(0, first, w, last - first);
    this.drawOpaque(pass, drawables);
    this.sum.bind();
    gl.clearColor(0, 0, 0, 0), gl.clear(gl.COLOR_BUFFER_BIT);
    let front: WebGLTexture | null = null;
    for (let k = 0; k < (through.length ? q.layers : 0); ++k) {
      const layer = this.layers[k % 2], before = k > 0 ? this.layers[(k + 1) % 2].depth! : null;
      layer.bind();
      gl.enable(gl.DEPTH_TEST), gl.depthFunc(gl.LESS), gl.depthMask(true), gl.disable(gl.BLEND);
      gl.clearColor(0, 0, 0, 0), gl.clearDepth(1), gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const peel = { before: before ?? this.nothing(), hiding: this.opaque.depth! };
      for (const d of through) d.draw({ ...pass, peel });
      for (const v of volumes) this.drawVolume(v, pass, front, this.nearer(layer, w, h), q.coarse);
      this.under(layer.color!);
      front = layer.depth!;
    }
    for (const v of volumes) this.drawVolume(v, pass, front, this.opaque.depth!, q.coarse);
    this.under(this.opaque.color!);
    gl.disable(gl.SCISSOR_TEST);
  }

  private drawOpaque(pass: Pass, drawables: Drawable[]): void {
    const gl = this.gl;
    this.opaque.bind();
    gl.enable(gl.DEPTH_TEST), gl.depthFunc(gl.LESS), gl.depthMask(true), gl.disable(gl.BLEND), gl.disable(gl.CULL_FACE), gl.disable(gl.STENCIL_TEST);
    gl.clearColor(0, 0, 0, 0), gl.clearDepth(1), gl.clearStencil(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    for (const stage of ["surface", "edges", "marks"] as const)
      for (const d of drawables) if (!d.translucent && d.stage === stage) d.draw({ ...pass, peel: null });
  }

  private drawVolume(v: Volume, pass: Pass, front: WebGLTexture | null, back: WebGLTexture, coarse: number): void {
    const gl = this.gl;
    this.sum.bind();
    gl.disable(gl.DEPTH_TEST), gl.enable(gl.BLEND), gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);
    v.draw({ ...pass, peel: null }, front, back, coarse);
    gl.disable(gl.BLEND);
  }

  /** A layer ends where what hides it begins: both were drawn against the same depths. */
  private nearer(layer: Target, w: number, h: number): WebGLTexture {
    const gl = this.gl;
    this.limit ??= new Target(gl, gl.R32F, false);
    this.limit.resize(w, h);
    this.limit.bind();
    this.limiter ??= new Program(gl, triangle, `
uniform sampler2D uOne, uOther;
out vec4 oColor;
void main() { ivec2 at = ivec2(gl_FragCoord.xy); oColor = vec4(min(texelFetch(uOne, at, 0).r, texelFetch(uOther, at, 0).r)); }`);
    this.limiter.use();
    this.limiter.texture("uOne", 0, layer.depth), this.limiter.texture("uOther", 1, this.opaque.depth);
    gl.disable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return this.limit.color!;
  }
  private limit: Target | null = null;
  private limiter: Program | null = null;

  private under(texture: WebGLTexture): void {
    const gl = this.gl;
    this.sum.bind();
    gl.disable(gl.DEPTH_TEST), gl.enable(gl.BLEND), gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);
    this.copy.use();
    this.copy.texture("uFrom", 0, texture);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.disable(gl.BLEND);
  }

  /** Depth 0 everywhere: before the first layer. */
  private nothing(): WebGLTexture {
    const gl = this.gl, bound = gl.getParameter(gl.FRAMEBUFFER_BINDING) as WebGLFramebuffer;
    const t = (this.zero ??= new Target(gl, gl.R8, false));
    t.resize(this.opaque.width, this.opaque.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.bindFramebuffer(gl.FRAMEBUFFER, bound);
    return t.color!;
  }
  private zero: Target | null = null;

  /** Waits until what was drawn is there. */
  finish(): void {
    const gl = this.gl;
    if (!this.sum.color) return;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.sum.frame);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4));
  }

  /** Into the window. */
  present(width: number, height: number, area: Area, samples: number): void {
    const gl = this.gl, p = this.resolve, s = this.scene;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.DEPTH_TEST), gl.disable(gl.BLEND), gl.disable(gl.SCISSOR_TEST);
    p.use();
    p.texture("uFrom", 0, this.sum.color);
    p.f("uArea", area.x, area.y, area.width, area.height), p.f("uWindow", width, height), p.f("uSamples", samples);
    p.f("uBottom", ...s.background), p.f("uTop", ...s.background_top);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}

