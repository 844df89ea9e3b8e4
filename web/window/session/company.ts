// SPDX-License-Identifier: Apache-2.0
// Others at the same session: telling them where one points and from where one looks, and looking along with one of them.
import type { App } from "../app";
import type { View } from "../view/view";

/** Cursors are told at most this often, in milliseconds. */
const pause = 60;

export class Company {
  /** The one whose view is followed. */
  following: number | null = null;
  private at: [number, number] = [0.5, 0.5];
  private told = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly app: App) {}

  pointed(view: View, at: [number, number]): void {
    this.at = [at[0] / view.size.width, at[1] / view.size.height];
    this.tell(view);
  }

  /** The camera was moved here, which ends looking along with somebody else. */
  moved(view: View): void {
    this.following = null;
    this.tell(view);
  }

  follow(id: number | null): void {
    this.following = id;
    this.peopleCame();
    this.app.changed();
  }

  peopleCame(): void {
    const { cursors } = this.app.session.people;
    const cursor = cursors.find((c) => c.id === this.following);
    if (this.following !== null && !cursor) this.following = null;
    if (cursor?.camera) this.app.views[0].look(cursor.camera, true, false);
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
    this.app.session.connection.tell({ do: "cursor", view: view.index, at: this.at, ...(view.camera ? { camera: view.camera } : {}) });
  }
}
