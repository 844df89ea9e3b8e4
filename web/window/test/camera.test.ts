// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { distanceOf, fit, frameOf, heightAtTarget, namedViews, pan, toggleProjection, zoom } from "../camera/camera";
import { dataBounds, dragged, draggedAlong, placeDragged, placeDraggedAlong, placeInView, toPixel } from "../camera/projection";
import { drag, onBall, roll, turn } from "../camera/trackball";
import { cross, dot, length, sub } from "../camera/vector";
import type { Camera, State, Vec3 } from "../protocol";
import { follow } from "../view/link";
import { randomNumbers } from "./random";

const camera = (more: Partial<Camera> = {}): Camera => ({
  position: [0, -10, 0],
  target: [0, 0, 0],
  up: [0, 0, 1],
  parallel: false,
  view_angle: 30,
  height: 5,
  ...more,
});
const size = { width: 800, height: 600 };
const near = (a: number[], b: number[], digits = 9): void => a.forEach((x, i) => expect(x).toBeCloseTo(b[i], digits));

describe("trackball", () => {
  it("keeps an orthonormal frame and its distance through 20000 random drags", () => {
    const random = randomNumbers(7);
    let c = camera();
    let worst = 0;
    for (let i = 0; i < 20000; i++) {
      const p = (): [number, number] => [random() * 4 - 2, random() * 4 - 2];
      c = drag(c, p(), p());
      const { right, up, back } = frameOf(c);
      const handed = sub(cross(right, up), back);
      const kept = sub(up, c.up); // the stored direction is the one that is used: nothing was guessed
      worst = Math.max(worst, Math.abs(dot(right, up)), Math.abs(dot(right, back)), Math.abs(dot(up, back)), length(handed), length(kept));
    }
    expect(worst).toBeLessThan(1e-12);
    expect(distanceOf(c)).toBeCloseTo(10, 7);
  });

  it("never locks: the same small drag turns by the same angle wherever one looks from, the poles included", () => {
    const small: [[number, number], [number, number]] = [[0, 0], [0.01, 0.02]];
    const angleOf = (c: Camera): number => {
      const a = frameOf(c);
      const b = frameOf(drag(c, ...small));
      return Math.acos(Math.min(1, (dot(a.right, b.right) + dot(a.up, b.up) + dot(a.back, b.back) - 1) / 2));
    };
    const expected = angleOf(camera());
    let c = camera();
    for (let i = 0; i < 360; i++) {
      c = turn(c, [1, 0, 0], Math.PI / 90); // over both poles, twice
      expect(angleOf(c)).toBeCloseTo(expected, 6);
    }
  });

  it("turns the near side of the scene along with the hand", () => {
    const point: Vec3 = [0, -1, 0]; // on the side of the viewer
    const before = toPixel(camera(), size, point)!;
    const after = toPixel(drag(camera(), [0, 0], [0.2, 0.1]), size, point)!;
    expect(after[0]).toBeGreaterThan(before[0]);
    expect(after[1]).toBeLessThan(before[1]);
  });

  it("is undone by the opposite turn, and rolls about the line of sight", () => {
    const c = turn(turn(camera(), [0.6, 0.8, 0], 1.1), [0.6, 0.8, 0], -1.1);
    near(c.position, camera().position);
    near(c.up, camera().up);
    const r = roll(camera(), Math.PI / 2);
    near(r.position, [0, -10, 0]);
    near(r.up, [1, 0, 0]); // the picture turns counter-clockwise, so up points to what was on the right
  });

  it("is smooth where the sphere passes into the hyperbola", () => {
    const edge = 0.8 / Math.SQRT2;
    expect(onBall(edge - 1e-9, 0)[2]).toBeCloseTo(onBall(edge + 1e-9, 0)[2], 6);
  });
});

describe("a picture that is stretched", () => {
  const state = { bounds: [0, 4, -30, 60, -2, 0], stretch: [1, 30, -2] } as unknown as State;

  it("has the bounds of the data back, turned round where it is turned round", () => {
    near(dataBounds(state)!, [0, 4, -1, 2, 0, 1]);
  });

  it("moves places of the data with the hand", () => {
    for (const parallel of [false, true]) {
      const c = camera({ parallel, position: [10, -80, 30], target: [2, 0, -1] });
      const place: Vec3 = [1, 0.2, 0.5];
      const at = placeInView(state, c, size, place)!;
      const by = placeDragged(state, c, size, place, 12, -7);
      const after = placeInView(state, c, size, place.map((x, i) => x + by[i]) as Vec3)!;
      near([after[0] - at[0], after[1] - at[1]], [12, -7], 6);
    }
  });

  it("moves a plane along its normal as far as the hand goes along that", () => {
    const place: Vec3 = [1, 0.2, 0.5], normal: Vec3 = [0, 0.6, 0.8];
    for (const parallel of [false, true])
      for (const way of [-0.5, 0.3, 0.8]) {
        const c = camera({ parallel, position: [10, -80, 30], target: [2, 0, -1], height: 50 });
        const at = placeInView(state, c, size, place)!;
        const end = placeInView(state, c, size, place.map((x, i) => x + way * normal[i]) as Vec3)!;
        expect(placeDraggedAlong(state, c, size, place, normal, end[0] - at[0], end[1] - at[1])).toBeCloseTo(way, 9);
      }
  });

  it("goes on without end where the hand is beyond the end of a direction in the picture", () => {
    const c = camera({ position: [0, -10, 3], target: [0, 0, 0] });
    expect(draggedAlong(c, size, [0, 0, 0], [0, 1, 0], 0, -1000)).toBeGreaterThan(1e6);
  });
});

describe("camera", () => {
  it("moves what lies in the plane of the target with the hand", () => {
    for (const parallel of [false, true]) {
      const c = camera({ parallel });
      const before = toPixel(c, size, [0, 0, 0])!;
      const after = toPixel(pan(c, 0.25, 0.1), size, [0, 0, 0])!;
      near([after[0] - before[0], after[1] - before[1]], [150, -60]);
    }
  });

  it("zooms about the place of the pointer", () => {
    for (const parallel of [false, true]) {
      const c = camera({ parallel });
      const h = heightAtTarget(c);
      const point: Vec3 = [0.3 * h, 0, 0.2 * h];
      const zoomed = zoom(c, 2.5, 0.3, 0.2);
      near(toPixel(zoomed, size, point)!, toPixel(c, size, point)!, 6);
      expect(heightAtTarget(zoomed)).toBeCloseTo(h / 2.5, 9);
    }
  });

  it("keeps the size of the target's plane between perspective and parallel", () => {
    const c = camera();
    const p = toggleProjection(c);
    expect(p.parallel).toBe(true);
    expect(heightAtTarget(p)).toBeCloseTo(heightAtTarget(c), 9);
    near(toggleProjection(p).position, c.position);
  });

  it("fits a box into the picture from each named view", () => {
    const box: [number, number, number, number, number, number] = [-1, 5, 2, 3, -4, 1];
    for (const parallel of [false, true])
      for (const v of [...namedViews(false), ...namedViews(true)]) {
        const c = fit(camera({ parallel }), box, v.direction, v.up, 800 / 600, 0.1);
        let widest = 0;
        for (let i = 0; i < 8; i++) {
          const corner: Vec3 = [box[i & 1], box[2 + ((i >> 1) & 1)], box[4 + (i >> 2)]];
          const p = toPixel(c, size, corner)!;
          const x = Math.abs(p[0] / 800 - 0.5) * 2;
          const y = Math.abs(p[1] / 600 - 0.5) * 2;
          expect(Math.max(x, y)).toBeLessThan(0.8 + 1e-9);
          widest = Math.max(widest, x, y);
        }
        expect(widest).toBeGreaterThan(0.79);
      }
  });

  it("fits flat and empty boxes without losing its axes", () => {
    for (const box of [[0, 0, 0, 0, 0, 0], [0, 1, 0, 1, 5, 5]] as [number, number, number, number, number, number][]) {
      const c = fit(camera(), box, [0, 0, 1], [0, 1, 0], 1.5);
      expect(distanceOf(c)).toBeGreaterThan(0);
      expect(length(frameOf(c).right)).toBeCloseTo(1, 12);
    }
  });

  it("drags a point by as many pixels as the pointer goes", () => {
    const c = turn(camera(), [0.3, 0.9, 0.1], 0.7);
    const point: Vec3 = [0.5, 0.4, -0.2];
    const by = dragged(c, size, point, 30, -12);
    const a = toPixel(c, size, point)!;
    const b = toPixel(c, size, [point[0] + by[0], point[1] + by[1], point[2] + by[2]])!;
    near([b[0] - a[0], b[1] - a[1]], [30, -12], 6);
    const parallel = { ...c, parallel: true };
    const along = draggedAlong(parallel, size, point, [0, 0, 1], 0, -40);
    expect(along).toBeGreaterThan(0);
  });
});

describe("linked views", () => {
  it("share place and magnification, and the turning if asked", () => {
    const a = camera();
    const b = camera({ position: [10, 0, 0] });
    const moved = zoom(pan(a, 0.1, 0), 2);
    const other = follow(b, a, moved, "place");
    near(other.target, moved.target);
    expect(distanceOf(other)).toBeCloseTo(5, 9);
    near(frameOf(other).back, frameOf(b).back);
    const turned = turn(a, [0, 1, 0], 0.5);
    near(frameOf(follow(a, a, turned, "all")).back, frameOf(turned).back);
    expect(dot(frameOf(follow(b, a, turned, "all")).back, frameOf(b).back)).toBeCloseTo(Math.cos(0.5), 9);
    expect(follow(b, a, turned, "none")).toBe(b);
    near(sub(follow(b, a, turned, "place").position, b.position), [0, 0, 0]);
  });
});
