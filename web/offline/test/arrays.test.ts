// SPDX-License-Identifier: Apache-2.0
import { deflateRawSync } from "node:zlib";
import { describe, expect, it } from "vitest";
import { ArrayStore, bytesOfBase64, decoded } from "../src/data/arrays";
import { normalsOf, positionsOf, scalePositions } from "../src/data/unpack";

/** As src/pipeline/offline/pack/arrays.cpp codes differences. */
function differences(values: number[], bytes: number, stride: number): Uint8Array<ArrayBuffer> {
  const n = values.length, out = new Uint8Array(n * bytes), full = 2 ** (8 * bytes);
  values.forEach((v, i) => {
    let d = v - (i >= stride ? values[i - stride] : 0);
    d = ((d % full) + full) % full;
    const zigzag = d < full / 2 ? 2 * d : 2 * (full - d) - 1;
    for (let k = 0; k < bytes; ++k) out[k * n + i] = Math.floor(zigzag / 256 ** k) % 256;
  });
  return out;
}

describe("arrays", () => {
  it("undoes differences of every type and stride", () => {
    for (const [type, bytes, values] of [
      ["u8", 1, [0, 255, 3, 128, 127, 1]],
      ["u16", 2, [0, 65535, 3, 40000, 1, 2]],
      ["u32", 4, [0, 4294967295, 3, 2147483648, 2147483647, 1]],
    ] as const)
      for (const stride of [1, 2, 3])
        expect(Array.from(decoded({ type, coding: "differences", stride, count: 6 }, differences([...values], bytes, stride)))).toEqual([...values]);
  });
  it("undoes planes of floats", () => {
    const floats = Float32Array.of(1.5, -3e38, 0), raw = new Uint8Array(floats.buffer), planes = new Uint8Array(12);
    for (let i = 0; i < 3; ++i) for (let k = 0; k < 4; ++k) planes[k * 3 + i] = raw[4 * i + k];
    expect(Array.from(decoded({ type: "f32", coding: "planes", stride: 1, count: 3 }, planes))).toEqual(Array.from(floats));
  });
  it("says so when bytes are missing", () => {
    expect(() => decoded({ type: "u16", coding: "plain", stride: 1, count: 3 }, new Uint8Array(5))).toThrow("damaged");
  });
  it("reads base64 and inflates, each array once", async () => {
    expect(Array.from(bytesOfBase64("Zm9v"))).toEqual([102, 111, 111]);
    const text = deflateRawSync(Buffer.from([7, 8, 9])).toString("base64");
    let asked = 0;
    const store = new ArrayStore([{ type: "u8", coding: "plain", stride: 1, count: 3 }], () => (++asked, text));
    expect(Array.from(await store.get(0))).toEqual([7, 8, 9]);
    await store.get(0);
    expect(asked).toBe(1);
  });
});

const storeOf = (values: Uint16Array) => ({ get: async () => values }) as unknown as ArrayStore;

describe("numbers of few bits", () => {
  it("puts places back over their box", async () => {
    const p = await positionsOf({ array: 0, bits: 16, lo: [0, 0, 0], size: [2, 4, 0], origin: [10, 0, 5] }, [10, 0, 0], storeOf(Uint16Array.of(0, 65535, 0, 65535, 0, 0)));
    expect(Array.from(p)).toEqual([0, 4, 5, 2, 0, 5]);
  });
  it("unfolds normals of both halves of the sphere", async () => {
    const n = await normalsOf({ array: 0, bits: 8 }, storeOf(Uint16Array.of(255, 128, 0, 0)));
    expect(n[0]).toBeGreaterThan(0.99);
    expect(n[5]).toBeCloseTo(-1, 5);
  });
  it("keeps the ends of a scale exact and what lies beyond beyond", () => {
    const t = scalePositions(Uint16Array.of(0, 4096, 61439, 4095, 61440, 65535), 16, -2, 3);
    expect(t[0]).toBeNaN();
    expect([t[1], t[2]]).toEqual([0, 1]);
    expect(t[3]).toBeLessThan(0);
    expect(t[4]).toBeGreaterThan(1);
    expect(t[5]).toBeCloseTo(3, 6);
  });
});
