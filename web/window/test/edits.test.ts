// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import type { Edit } from "../protocol";
import { Edits } from "../session/edits";

const set = (value: string, word = "values"): Edit[] => [{ at: "steps/c", set: { [word]: value } }];

describe("edits", () => {
  it("keeps one under way and only the newest live one behind it", () => {
    const e = new Edits();
    e.put(set("1"), true);
    e.sent(1, e.next()!);
    for (let i = 2; i <= 50; i++) e.put(set(String(i)), true);
    expect(e.next()).toBe(null);
    expect(e.draft("steps/c", "values")).toBe("50"); // the control stays under the hand
    e.stateCame(1);
    expect(e.draft("steps/c", "values")).toBe("50");
    const last = e.next()!;
    expect(last.edits).toEqual(set("50"));
    e.sent(2, last);
    e.stateCame(2);
    expect(e.draft("steps/c", "values")).toBe(undefined);
    expect(e.next()).toBe(null);
  });

  it("ends a drag with an edit that is not live", () => {
    const e = new Edits();
    e.put(set("1"), true);
    e.sent(1, e.next()!);
    e.put(set("2"), true);
    e.put(set("3"), false);
    e.stateCame(1);
    expect(e.next()).toMatchObject({ live: false, edits: set("3") });
    expect(e.next()).not.toBe(undefined);
  });

  it("joins words of one place and keeps edits of different places apart", () => {
    const e = new Edits();
    e.put(set("0"), false);
    e.sent(1, e.next()!);
    e.put(set("1"), true);
    e.put(set("7", "count"), true);
    e.put([{ at: "show/0", set: { map: "ice" } }], true);
    e.stateCame(1);
    const joined = e.next()!;
    expect(joined.edits).toEqual([{ at: "steps/c", set: { values: "1", count: "7" } }]);
    e.sent(2, joined);
    e.stateCame(2);
    expect(e.next()?.edits).toEqual([{ at: "show/0", set: { map: "ice" } }]);
  });

  it("keeps what was refused at its control, with the objection, until the session changes", () => {
    const e = new Edits();
    e.put(set("x"), false);
    e.sent(1, e.next()!);
    e.refused(1, [{ at: "steps/c", word: "values", text: "'x' is no number" }]);
    expect(e.draft("steps/c", "values")).toBe("x");
    expect(e.problem("steps/c", "values")).toBe("'x' is no number");
    e.put(set("4"), false);
    expect(e.problem("steps/c", "values")).toBe(undefined);
    e.sent(2, e.next()!);
    e.stateCame(2);
    expect(e.draft("steps/c", "values")).toBe(undefined);
  });

  it("forgets everything when the connection is lost", () => {
    const e = new Edits();
    e.put(set("1"), true);
    e.sent(1, e.next()!);
    e.put(set("2"), true);
    e.lost();
    expect(e.next()).toBe(null);
    expect(e.draft("steps/c", "values")).toBe(undefined);
  });
});
