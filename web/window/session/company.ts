// SPDX-License-Identifier: Apache-2.0
// Others at the same session: telling them where one points and from where one looks, looking along with one of them, and one view for all.
import type { App } from "../app";
import type { View } from "../view/view";

/** Cursors are told at most this often, in milliseconds. */
const pause = 60;
/** Who has moved the view so many milliseconds ago is not led by others: two hands would pull at it. */
const hold = 400;

export class Company {
  /** The one whose view is followed. */
  following: number | null = null;
  private at: [number, number] = [0.5, 0.5];
  private told = 0;
  private movedAt = -Infinity;
  private leads = false; // what is told next is where the view was moved to
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly app: App) {}

  pointed(view: View, at: [number, number]): void {
    this.at = [at[0] / view.size.width, at[1] / view.size.height];
    this.tell(view);
  }

  /** The camera was moved here, which ends looking along with somebody else. */
  moved(view: View): void {
    this.following = null;
    if (view.index === 0) {
      this.leads = true;
      this.movedAt = performance.now();
    }
    this.tell(view);
  }

  follow(id: number | null): void {
    this.following = id;
    this.peopleCame();
    this.app.changed();
  }

  /** One view for all windows: this one's to begin with. */
  setTogether(on: boolean): void {
    const { camera } = this.app.views[0];
    this.following = null;
    this.app.session.connection.tell({ do: "together", on, ...(on && camera ? { camera } : {}) });
  }

  peopleCame(): void {
    const { cursors, together, camera, led } = this.app.session.people;
    const cursor = cursors.find((c) => c.id === this.following);
    if (this.following !== null && !cursor) this.following = null;
    const view = this.app.views[0];
    if (together) {
      if (camera && !led && performance.now() - this.movedAt > hold && JSON.stringify(camera) !== JSON.stringify(view.camera)) view.look(camera, true, false);
    } else if (cursor?.camera) view.look(cursor.camera, true, false);
  }

  private tell(view: View): void {
    if (this.app.session.people.count < 2) return;
    clearTimeout(this.timer);
    const wait = this.told + pause - performance.now();
    if (wait > 0) {
      this.timer = setTimeout(() => this.tell(view), wait);
      return;
    }
    this.told = performance.now();
    const leads = this.leads && view.index === 0;
    if (leads) this.leads = false;
    this.app.session.connection.tell({ do: "cursor", view: view.index, at: this.at, ...(view.camera ? { camera: view.camera } : {}), ...(leads ? { leads } : {}) });
  }
}
