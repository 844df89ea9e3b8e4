// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import type { FrameHeader } from "../protocol";
import { Drawing, droppedAfter, restAfter } from "../view/drawing";

const frame = (n: number, revision: number, coarse = 1, final = coarse === 1): FrameHeader => ({
  is: "frame", n, view: 0, revision, type: "image/png", size: [8, 8], of: [8, 8], coarse, final, milliseconds: 1,
  camera: { position: [0, 0, 1], target: [0, 0, 0], up: [0, 1, 0], parallel: false, view_angle: 30, height: 1 },
});

/** What a view does with a frame that comes. */
const come = (d: Drawing, f: FrameHeader): boolean => {
  const fresh = d.fresh(f);
  if (fresh) d.show(f);
  return fresh;
};

describe("which pictures are shown", () => {
  it("drops what is behind in request, revision or sharpness, and shows what is ahead", () => {
    const d = new Drawing();
    expect(come(d, frame(5, 2, 4))).toBe(true);
    expect(come(d, frame(4, 2, 1))).toBe(false); // an older request, however sharp
    expect(come(d, frame(5, 1, 1))).toBe(false); // an older revision
    expect(come(d, frame(5, 2, 8))).toBe(false); // coarser than what is seen
    expect(come(d, frame(5, 2, 2))).toBe(true);
    expect(come(d, frame(5, 2, 1))).toBe(true);
    expect(come(d, frame(5, 2, 1))).toBe(false); // the same once more
    expect(come(d, frame(5, 3, 4))).toBe(true); // after an edit it begins coarse again
    expect(come(d, frame(6, 2, 1))).toBe(false);
    expect(come(d, frame(6, 3, 4))).toBe(true);
  });

  it("never shows an older picture in 5000 that come in random order", () => {
    const d = new Drawing();
    let s = 1;
    const random = (k: number): number => (s = (s * 48271) % 2147483647) % k;
    let n = 0;
    let revision = 0;
    for (let i = 0; i < 5000; i++) {
      const f = frame(random(i + 1), random(20 + i / 50), 1 + random(4));
      if (!come(d, f)) continue;
      expect(f.n).toBeGreaterThanOrEqual(n);
      expect(f.revision).toBeGreaterThanOrEqual(revision);
      n = f.n;
      revision = f.revision;
    }
  });

  it("takes numbers from the beginning after a new connection", () => {
    const d = new Drawing();
    come(d, frame(50, 9));
    d.restart();
    expect(come(d, frame(1, 1, 4))).toBe(true);
  });
});

describe("when pictures are asked for", () => {
  it("asks for one quick picture at a time and for the still one after the hand rests", () => {
    const d = new Drawing();
    d.want(0, true);
    expect(d.due(1)).toBe("moving");
    d.asked(1, 1, "moving");
    d.want(16, true);
    expect(d.due(17)).toBe(null); // the first has not come
    expect(come(d, frame(1, 1, 3))).toBe(true);
    expect(d.due(18)).toBe("moving");
    d.asked(2, 18, "moving");
    expect(d.due(100)).toBe(null);
    expect(d.due(16 + restAfter)).toBe("still"); // even though the second has not come
    d.asked(3, 140, "still");
    expect(d.due(1000)).toBe(null);
  });

  it("goes on when a picture was dropped", () => {
    const d = new Drawing();
    d.want(0, true);
    d.asked(1, 0, "moving");
    d.want(droppedAfter, true);
    expect(d.due(droppedAfter - 1)).toBe(null);
    expect(d.due(droppedAfter + 1)).toBe("moving");
  });

  it("sends at most one request per picture that comes, over a long drag", () => {
    const d = new Drawing();
    let n = 0;
    let came = 0;
    for (let now = 0; now < 5000; now += 16) {
      d.want(now, true);
      if (d.due(now) === "moving") d.asked(++n, now, "moving");
      if (now % 96 === 0 && n > came) come(d, frame((came = n), 1, 3));
    }
    expect(n).toBeLessThanOrEqual(5000 / 96 + 2);
    expect(n).toBeGreaterThan(40);
  });

  it("is settled with the final picture of the last request and revision only", () => {
    const d = new Drawing();
    d.want(0, false);
    expect(d.due(1)).toBe("still");
    d.asked(1, 1, "still");
    come(d, frame(1, 1, 4));
    expect(d.settled(1)).toBe(false);
    come(d, frame(1, 1));
    expect(d.settled(1)).toBe(true);
    expect(d.settled(2)).toBe(false);
  });
});
