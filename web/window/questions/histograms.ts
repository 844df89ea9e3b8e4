// SPDX-License-Identifier: Apache-2.0
// Histograms of fields and of the plane of value and second axis, asked once per revision and kept. A server that does not answer such
// questions is not asked again.
import type { App } from "../app";
import type { Histogram, HistogramAnswer, PlaneAnswer, PlanePlaceAnswer } from "../protocol";

export class Histograms {
  private known = new Map<string, Histogram | null>();
  private planes = new Map<string, PlaneAnswer | null>();
  private places = new Map<string, [number, number] | null>();
  private revision = 0;
  private unknownToServer = false;
  private readonly begins = performance.now() + 3000;

  constructor(private readonly app: App) {}

  stateCame(): void {
    const s = this.app.state;
    if (!s || s.revision === this.revision) return;
    this.revision = s.revision;
    this.planes.clear();
    this.places.clear();
  }

  /** The histogram of a step's field, once it is known; asks for it at first. */
  of(step: string, field: string): Histogram | null {
    const key = `${this.app.session.step(step)?.size} ${this.app.state?.time} ${step} ${field}`;
    const known = this.known.get(key);
    if (known !== undefined || this.unknownToServer) return known ?? null;
    if (!this.app.view.frame && performance.now() < this.begins) return null; // the first picture comes first
    this.known.set(key, null);
    this.app.session
      .ask<HistogramAnswer>({ do: "histogram", step, field })
      .then((a) => {
        this.known.set(key, { range: a.range, counts: a.counts });
        this.app.changed();
      })
      .catch(() => (this.unknownToServer = true));
    return null;
  }

  plane(show: number): PlaneAnswer | null {
    const t = this.app.session.shown(show)?.transfer;
    const key = `${show} ${t?.field} ${this.app.state?.time}`;
    const known = this.planes.get(key);
    if (known !== undefined) return known;
    this.planes.set(key, null);
    this.app.session
      .ask<PlaneAnswer>({ do: "plane", show })
      .then((a) => {
        this.planes.set(key, a);
        this.app.changed();
      })
      .catch(() => undefined);
    return null;
  }

  /** Where the place that was clicked in the picture lies in that plane, once it is known. In nodes the data lie elsewhere. */
  placeInPlane(show: number): [number, number] | null {
    const shown = this.app.session.shown(show);
    const position = this.app.probe.pinned?.answer.position;
    if (!position || !shown || shown.in) return null;
    const key = `${show} ${shown.transfer?.field} ${shown.words.second} ${this.app.state?.time} ${position}`;
    const known = this.places.get(key);
    if (known !== undefined) return known;
    this.places.set(key, null);
    this.app.session
      .ask<PlanePlaceAnswer>({ do: "plane", show, at: position })
      .then((a) => {
        this.places.set(key, a.at ?? null);
        this.app.changed();
      })
      .catch(() => undefined);
    return null;
  }
}
