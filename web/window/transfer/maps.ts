// SPDX-License-Identifier: Apache-2.0
// The colour maps to choose from.
import { mapTable } from "./map_table";

export interface ColorMap {
  name: string;
  kind: string;
  about: string;
  colors: string[];
}

export const maps: ColorMap[] = mapTable.map(([name, kind, about, hex]) => ({
  name,
  kind,
  about,
  colors: hex.match(/.{6}/g)!.map((c) => `#${c}`),
}));

export const mapNames: string[] = maps.map((m) => m.name);

/** A map by its name, also a reversed one (NAME_r). */
export function mapByName(name: string): ColorMap | undefined {
  const reversed = name.endsWith("_r");
  const found = maps.find((m) => m.name === (reversed ? name.slice(0, -2) : name)) ?? maps.find((m) => m.name === name);
  return found && reversed && found.name !== name ? { ...found, name, colors: [...found.colors].reverse() } : found;
}

/** CIELAB lightness (D65) of a colour #rrggbb, 0 to 1. */
export function lightness(hex: string): number {
  const linear = (i: number): number => {
    const c = parseInt(hex.slice(i, i + 2), 16) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  };
  const y = 0.2126729 * linear(1) + 0.7151522 * linear(3) + 0.072175 * linear(5);
  return (y > 216 / 24389 ? 116 * Math.cbrt(y) - 16 : (y * 24389) / 27) / 100;
}
