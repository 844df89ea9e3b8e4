// SPDX-License-Identifier: Apache-2.0
// Measurements in the picture: places that are clicked one after the other, and those that were kept.
import type { App } from "../app";
import type { Vec3 } from "../protocol";
import { csv } from "../questions/files";
import type { View } from "../view/view";
import { plain } from "../words";
import { keptFrom, keptText, plainName, type Measurement } from "./kept";
import { measured, mostUneven, unevenness, type Measured } from "./geometry";

const powers = { distance: "", length: "", area: "²" };

/** A measured number for people, with its unit. */
export function measuredText(m: Measured, lengthUnit: string): string {
  if (m.what === "angle") return `${plain(m.value)}°`;
  return `${plain(m.value, 5)}${lengthUnit ? ` ${lengthUnit}${powers[m.what]}` : ""}`;
}

/** All of a measurement in one line: "length 3 mm, area 2 mm², not flat". */
export function summary(points: Vec3[], lengthUnit: string): string {
  const texts = measured(points).map((m) => `${m.what} ${measuredText(m, lengthUnit)}`);
  if (points.length > 3 && unevenness(points) > mostUneven) texts.push("not flat");
  return texts.join(", ");
}

export class Rulers {
  points: Vec3[] = [];
  private own: Measurement[] = []; // of a window that may not change the session
  private read = { text: "", kept: [] as Measurement[] };

  constructor(private readonly app: App) {}

  /** Those of the session, which all of its windows see, and which are in its file. */
  get kept(): Measurement[] {
    const text = this.app.session.word("picture", "measurements") ?? "";
    if (text !== this.read.text) this.read = { text, kept: keptFrom(text) };
    return this.own.length > 0 ? [...this.read.kept, ...this.own] : this.read.kept;
  }

  private put(kept: Measurement[]): void {
    if (this.app.state?.may_edit) {
      this.own = [];
      this.app.session.set("picture", { measurements: kept.length > 0 ? keptText(kept) : null });
    } else {
      this.own = kept.slice(this.read.kept.length);
    }
    this.app.changed();
  }

  /** Puts a place on what is seen under a pixel of a view. */
  async click(view: View, at: [number, number]): Promise<void> {
    const answer = await this.app.probe.at(view, at);
    if (answer?.position) this.add(answer.position);
    else this.app.say("There is nothing to measure at this place");
  }

  /** As a click into the middle of the picture. */
  clickMiddle(view: View): Promise<void> {
    const a = view.area;
    return this.click(view, [a.x + a.width / 2, a.y + a.height / 2]);
  }

  add(point: Vec3): void {
    this.points = [...this.points, point];
    const text = summary(this.points, this.app.state?.length_unit ?? "");
    // Read aloud, too: the labels are part of the picture.
    this.app.say(text || "First place of a measurement");
  }

  /** Takes the last place away; false where there is none. */
  back(): boolean {
    if (this.points.length === 0) return false;
    this.points = this.points.slice(0, -1);
    this.app.changed();
    return true;
  }

  clear(): boolean {
    if (this.points.length === 0) return false;
    this.points = [];
    this.app.changed();
    return true;
  }

  keep(): void {
    if (this.points.length < 2) return;
    const names = new Set(this.kept.map((m) => m.name));
    let number = 1;
    while (names.has(`Measurement ${number}`)) ++number;
    const points = this.points;
    this.points = [];
    this.put([...this.kept, { name: `Measurement ${number}`, points }]);
  }

  rename(index: number, name: string): void {
    this.put(this.kept.map((m, i) => (i === index ? { ...m, name: plainName(name) } : m)));
  }

  drop(index: number): void {
    this.put(this.kept.filter((_, i) => i !== index));
  }

  /** One line per number; places as x y z, one after the other. */
  csv(): string {
    const unit = this.app.state?.length_unit ?? "";
    const units = { distance: unit, length: unit, angle: "degrees", area: unit && `${unit}^2` };
    const rows = this.kept.flatMap((m) =>
      measured(m.points).map((x) => [m.name, x.what, x.value, units[x.what], x.what === "area" && unevenness(m.points) > mostUneven ? "not flat" : "", m.points.map((p) => p.join(" ")).join("; ")]),
    );
    return csv(["name", "what", "value", "unit", "note", "places"], rows);
  }
}
