// SPDX-License-Identifier: Apache-2.0
// Values over a distance or over times, null where there are none.

export interface Curve {
  x: number[];
  values: (number | null)[];
}
