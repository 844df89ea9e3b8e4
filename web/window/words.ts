// SPDX-License-Identifier: Apache-2.0
// Numbers and lists as text: as the command line takes them, and as people read them.

/** The shortest decimal that is read back as the same number to seven digits: what a slider or a drag gives. */
export const short = (x: number): string => String(Number(x.toPrecision(7)));

/** A number for people: few digits, and a minus sign. */
export function plain(x: number | null | undefined, digits = 4): string {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  const a = Math.abs(x);
  const text = a !== 0 && (a >= 1e6 || a < 1e-4) ? x.toExponential(digits - 1).replace(/\.?0+e/, "e") : String(Number(x.toPrecision(digits)));
  return text.replace("-", "−").replace("e+", "e");
}

/** Numbers of a list as the command line takes it; null where one of them is no number. */
export function numbers(text: string): number[] | null {
  const parts = text.split(/[\s,;]+/).filter((s) => s !== "");
  const values = parts.map(Number);
  return values.every((v) => Number.isFinite(v)) ? values : null;
}

export function bytes(n: number | null | undefined): string {
  if (n === null || n === undefined) return "–";
  const units = ["B", "kB", "MB", "GB", "TB"];
  let i = 0;
  let v = n;
  while (v >= 1000 && i < units.length - 1) {
    v /= 1000;
    i++;
  }
  return `${v < 10 && i > 0 ? v.toFixed(1) : Math.round(v)} ${units[i]}`;
}

export function seconds(s: number | null | undefined): string {
  if (s === null || s === undefined) return "–";
  return s < 0.0995 ? `${(s * 1000).toFixed(s < 0.00995 ? 1 : 0)} ms` : `${s < 9.95 ? s.toFixed(2) : s.toFixed(0)} s`;
}

/** A word of the command line in single quotes where it needs them. */
export const quoted = (text: string): string => (/^[\w@:.,+%=/-]*$/.test(text) && text !== "" ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** The name of a parameter for people. */
export const title = (name: string): string => {
  const text = name.replaceAll("_", " ");
  return text.charAt(0).toUpperCase() + text.slice(1);
};
