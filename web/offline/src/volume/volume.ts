// SPDX-License-Identifier: Apache-2.0
// A volume on the graphics card: its lattice, its tables, and where it is empty.
import type { ArrayStore } from "../data/arrays";
import type { Triple, VolumeInfo } from "../data/format";
import { floatTable, type GL, Program } from "../draw/gl";
import { bindPass, type Pass } from "../draw/pass";
import type { Scale } from "../draw/scales";
import { sub, type Vec3 } from "../view/vec";
import { type Bricks, bricksOf, distances } from "./bricks";
import { fragment, modes, type Variant, vertex } from "./shader";
import { countsOf, type Curve, makeTables, opacityAt, tableSize } from "./transfer";

const programs = new Map<string, Program>();
function programOf(gl: GL, v: Variant): Program {
  const key = JSON.stringify(v);
  let found = programs.get(key);
  if (!found) programs.set(key, (found = new Program(gl, vertex, fragment(v))));
  return found;
}

function lattice(gl: GL, dims: readonly number[], format: number, of: number, type: number, data: ArrayBufferView<ArrayBuffer>, filter: number): WebGLTexture {
  const texture = gl.createTexture()!;
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_3D, texture);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texStorage3D(gl.TEXTURE_3D, 1, format, dims[0], dims[1], dims[2]);
  gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, dims[0], dims[1], dims[2], of, type, data);
  for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_R, gl.CLAMP_TO_EDGE]])
    gl.texParameteri(gl.TEXTURE_3D, name, value);
  return texture;
}

export class Volume {
  points: Curve;
  private values!: WebGLTexture;
  private gaps: WebGLTexture | null = null;
  private space: WebGLTexture | null = null;
  private medium: WebGLTexture | null = null;
  private sums: WebGLTexture | null = null;
  private bricks!: Bricks;
  private readonly origin: Vec3;

  private constructor(private readonly gl: GL, readonly info: VolumeInfo, readonly scale: Scale, center: Triple) {
    this.points = info.opacity.map(([v, o]) => [v, o]);
    this.origin = sub(info.origin, center);
  }

  static async load(gl: GL, info: VolumeInfo, center: Triple, scales: Scale[], store: ArrayStore): Promise<Volume> {
    const v = new Volume(gl, info, scales[info.scale], center);
    const codes = (await store.get(info.array)) as Uint8Array<ArrayBuffer> | Uint16Array<ArrayBuffer>;
    const filter = info.nearest ? gl.NEAREST : gl.LINEAR;
    if (info.bits === 8) v.values = lattice(gl, info.dims, gl.R8, gl.RED, gl.UNSIGNED_BYTE, codes, filter);
    else {
      // 16 bits interpolate in floats where the browser can, else in halves.
      const floats = Float32Array.from(codes, (c) => c / 65535), full = gl.getExtension("OES_texture_float_linear") || info.nearest;
      v.values = lattice(gl, info.dims, full ? gl.R32F : gl.R16F, gl.RED, gl.FLOAT, floats, filter);
    }
    if (info.left_out !== undefined) {
      const less = info.cells ? 0 : 1;
      v.gaps = lattice(gl, info.dims.map((n) => n - less), gl.R8, gl.RED, gl.UNSIGNED_BYTE, (await store.get(info.left_out)) as Uint8Array<ArrayBuffer>, gl.NEAREST);
    }
    v.bricks = bricksOf(codes, info.dims, info.bits === 8 ? 255 : 65535);
    v.setOpacity(v.points);
    return v;
  }

  setOpacity(points: Curve): void {
    const gl = this.gl, info = this.info;
    this.points = points;
    const tables = makeTables(info, this.scale, points), counts = countsOf(tables.seen), last = tableSize - 1;
    gl.deleteTexture(this.medium), gl.deleteTexture(this.sums), gl.deleteTexture(this.space);
    this.medium = floatTable(gl, tables.medium), this.sums = floatTable(gl, tables.sums);
    const levels = info.levels.map((l) => (l - info.least) / (info.most - info.least));
    const drawn = (lo: number, hi: number) => {
      if (info.mode === "isosurface") return levels.some((l) => l >= lo && l <= hi);
      if (info.mode === "first_hit") return hi >= levels[0];
      const a = Math.max(0, Math.floor(lo * last) - 1), b = Math.min(last, Math.ceil(hi * last) + 1);
      return counts[b + 1] > counts[a];
    };
    this.space = lattice(gl, this.bricks.dims, gl.R8, gl.RED, gl.UNSIGNED_BYTE, distances(this.bricks, drawn) as Uint8Array<ArrayBuffer>, gl.NEAREST);
  }

  /** The part between two depths, over what the target holds already. */
  draw(pass: Pass, front: WebGLTexture | null, back: WebGLTexture, coarse: number): void {
    const gl = this.gl, info = this.info, m = info.to_u;
    const mode = Math.max(0, modes.indexOf(info.mode)), p = programOf(gl, { mode, lit: info.lit, gaps: this.gaps !== null, nearest: info.nearest, cells: info.cells, fast: pass.moving });
    p.use();
    bindPass(p, pass);
    p.texture("uLattice", 0, this.values, gl.TEXTURE_3D), p.texture("uDistance", 1, this.space, gl.TEXTURE_3D), p.texture("uLeftOut", 2, this.gaps ?? this.values, gl.TEXTURE_3D);
    p.texture("uMedium", 3, this.medium), p.texture("uSums", 4, this.sums);
    this.scale.bind(p, 5);
    p.texture("uFront", 6, front ?? back), p.texture("uBack", 7, back);
    p.i("uHasFront", front ? 1 : 0);
    gl.uniformMatrix3fv(p.place("uToU"), false, [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]]);
    p.f("uOrigin", ...this.origin), p.f("uLo", ...info.lo), p.f("uHi", ...info.hi), p.f("uDims", ...info.dims), p.f("uSamplesAlong", ...info.samples);
    const texel = Math.max(...info.samples.map((s, a) => s / info.dims[a]));
    p.f("uStep", 0.5 * info.edge * texel * coarse), p.f("uEdge", info.edge), p.f("uPerSurface", 1 / info.surface_from), p.f("uLeast", info.least), p.f("uMost", info.most);
    const levels = info.levels.slice(0, 8);
    p.i("uLevelCount", levels.length);
    if (levels.length) {
      gl.uniform1fv(p.place("uLevels"), levels);
      gl.uniform1fv(p.place("uLevelOpacity"), levels.map((l) => opacityAt(this.points, l)));
    }
    const planes: number[] = [];
    for (let i = 0; i + 3 < info.clip.length && planes.length < 48; i += 4) {
      const n = info.clip.slice(i, i + 3) as Vec3;
      planes.push(...n, info.clip[i + 3] - (n[0] * pass.center[0] + n[1] * pass.center[1] + n[2] * pass.center[2]));
    }
    p.i("uPlaneCount", planes.length / 4);
    if (planes.length) gl.uniform4fv(p.place("uPlanes"), planes);
    p.f("uMaterial", ...info.material);
    p.f("uScaleLo", this.scale.info.lo), p.f("uScaleHi", this.scale.info.hi), p.f("uThreshold", this.scale.info.threshold);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
