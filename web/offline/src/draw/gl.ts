// SPDX-License-Identifier: Apache-2.0
// Programs, buffers and targets of WebGL2.

export type GL = WebGL2RenderingContext;

export class Program {
  readonly handle: WebGLProgram;
  private readonly places = new Map<string, WebGLUniformLocation | null>();

  constructor(readonly gl: GL, vertex: string, fragment: string) {
    const handle = gl.createProgram()!;
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
      const shader = gl.createShader(type)!;
      gl.shaderSource(shader, "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler3D;\n" + text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? "a shader cannot be compiled");
      gl.attachShader(handle, shader);
    }
    gl.linkProgram(handle);
    if (!gl.getProgramParameter(handle, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(handle) ?? "a program cannot be linked");
    this.handle = handle;
  }
  use(): void {
    this.gl.useProgram(this.handle);
  }
  place(name: string): WebGLUniformLocation | null {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.handle, name));
    return this.places.get(name)!;
  }
  f(name: string, ...v: number[]): void {
    const gl = this.gl, at = this.place(name);
    if (v.length === 1) gl.uniform1f(at, v[0]);
    else if (v.length === 2) gl.uniform2f(at, v[0], v[1]);
    else if (v.length === 3) gl.uniform3f(at, v[0], v[1], v[2]);
    else gl.uniform4f(at, v[0], v[1], v[2], v[3]);
  }
  i(name: string, v: number): void {
    this.gl.uniform1i(this.place(name), v);
  }
  texture(name: string, unit: number, texture: WebGLTexture | null, target: number = this.gl.TEXTURE_2D): void {
    this.gl.activeTexture(this.gl.TEXTURE0 + unit);
    this.gl.bindTexture(target, texture);
    this.i(name, unit);
  }
}

/** Attributes are bound to numbers, the same in all programs. */
export function attribute(gl: GL, at: number, data: ArrayBufferView<ArrayBuffer>, size: number, divisor = 0, type: number = gl.FLOAT, normalized = false, stride = 0, offset = 0): WebGLBuffer {
  const buffer = gl.createBuffer()!;
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
  point(gl, at, buffer, size, divisor, type, normalized, stride, offset);
  return buffer;
}
export function point(gl: GL, at: number, buffer: WebGLBuffer, size: number, divisor: number, type: number, normalized: boolean, stride: number, offset: number): void {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, size, type, normalized, stride, offset);
  gl.vertexAttribDivisor(at, divisor);
}

export class Target {
  width = 0;
  height = 0;
  readonly frame: WebGLFramebuffer;
  color: WebGLTexture | null = null;
  depth: WebGLTexture | null = null;

  constructor(private readonly gl: GL, private readonly format: number, private readonly withDepth: boolean) {
    this.frame = gl.createFramebuffer()!;
  }
  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    const gl = this.gl;
    this.width = width, this.height = height;
    gl.deleteTexture(this.color), gl.deleteTexture(this.depth);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    this.color = storage(gl, this.format, width, height, gl.LINEAR);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.color, 0);
    if (this.withDepth) {
      this.depth = storage(gl, gl.DEPTH24_STENCIL8, width, height, gl.NEAREST);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_STENCIL_ATTACHMENT, gl.TEXTURE_2D, this.depth, 0);
    }
  }
  bind(): void {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.frame);
    this.gl.viewport(0, 0, this.width, this.height);
  }
}

function storage(gl: GL, format: number, width: number, height: number, filter: number): WebGLTexture {
  const texture = gl.createTexture()!;
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
    gl.texParameteri(gl.TEXTURE_2D, name, value);
  return texture;
}

/** A list of RGBA floats as rows of 1024, read by texelFetch. */
export function floatTable(gl: GL, rgba: Float32Array): WebGLTexture {
  const count = rgba.length / 4, rows = Math.max(1, Math.ceil(count / 1024)), full = new Float32Array(rows * 4096);
  full.set(rgba);
  const texture = storage(gl, gl.RGBA32F, 1024, rows, gl.NEAREST);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 1024, rows, gl.RGBA, gl.FLOAT, full);
  return texture;
}
