// SPDX-License-Identifier: Apache-2.0
// Arrays of the page: base64, deflate, and the codings of src/pipeline/offline/pack/arrays.h.
import type { ArrayInfo } from "./format";

export type Numbers = Uint8Array | Uint16Array | Uint32Array | Float32Array;

export function bytesOfBase64(text: string): Uint8Array<ArrayBuffer> {
  const own = Uint8Array as unknown as { fromBase64?: (text: string) => Uint8Array<ArrayBuffer> };
  if (own.fromBase64) return own.fromBase64(text);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

export async function inflated(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function empty(info: ArrayInfo): Numbers {
  switch (info.type) {
    case "u8": return new Uint8Array(info.count);
    case "u16": return new Uint16Array(info.count);
    case "u32": return new Uint32Array(info.count);
    default: return new Float32Array(info.count);
  }
}

/** The numbers of an array from its coded bytes. */
export function decoded(info: ArrayInfo, bytes: Uint8Array<ArrayBuffer>): Numbers {
  const out = empty(info);
  const size = out.BYTES_PER_ELEMENT, n = info.count, stride = info.stride;
  if (bytes.length !== n * size) throw new Error(`an array has ${bytes.length} bytes, not ${n * size}: the file is damaged`);
  if (info.coding === "plain") {
    new Uint8Array(out.buffer).set(bytes);
  } else if (info.coding === "planes") {
    const to = new Uint8Array(out.buffer);
    for (let k = 0; k < size; ++k) for (let i = 0, at = k * n; i < n; ++i) to[i * size + k] = bytes[at + i];
  } else {
    for (let i = 0; i < n; ++i) {
      let zigzag = bytes[i];
      if (size > 1) zigzag |= bytes[n + i] << 8;
      if (size > 2) zigzag |= (bytes[2 * n + i] << 16) | (bytes[3 * n + i] << 24);
      const d = (zigzag >>> 1) ^ -(zigzag & 1);
      out[i] = i >= stride ? d + out[i - stride] : d;
    }
  }
  return out;
}

/** Arrays by number, each decoded when it is first asked for. */
export class ArrayStore {
  private readonly kept = new Map<number, Promise<Numbers>>();
  constructor(private readonly infos: ArrayInfo[], private readonly text: (n: number) => string) {}

  get(n: number): Promise<Numbers> {
    let found = this.kept.get(n);
    if (!found) {
      found = inflated(bytesOfBase64(this.text(n))).then((bytes) => decoded(this.infos[n], bytes));
      this.kept.set(n, found);
    }
    return found;
  }
}
