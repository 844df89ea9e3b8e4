// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { ServerMessage } from "../protocol";
import { Connection, type Connected } from "../session/socket";

class Fake {
  static made: Fake[] = [];
  readyState = 0;
  binaryType = "";
  sent: Record<string, unknown>[] = [];
  onopen: (() => void) | null = null;
  onclose: (() => void) | null = null;
  onmessage: ((e: { data: unknown }) => void) | null = null;
  constructor() {
    Fake.made.push(this);
  }
  send(text: string): void {
    this.sent.push(JSON.parse(text));
  }
  close(): void {
    this.readyState = 3;
    this.onclose?.();
  }
  accept(): void {
    this.readyState = 1;
    this.onopen?.();
  }
  say(message: unknown): void {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
}

const last = (): Fake => Fake.made[Fake.made.length - 1];

describe("connection", () => {
  let messages: ServerMessage[] = [];
  let how: Connected[] = [];
  let c: Connection;
  beforeEach(() => {
    vi.useFakeTimers();
    Fake.made = [];
    messages = [];
    how = [];
    c = new Connection("ws://x", { message: (m) => messages.push(m), frame: () => undefined, connected: (h) => how.push(h) }, () => new Fake() as unknown as WebSocket);
    c.open();
    last().accept();
  });
  afterEach(() => vi.useRealTimers());

  it("gives the first request with the address, once", () => {
    const urls: string[] = [];
    c = new Connection("ws://x/socket?open=a", { message: () => undefined, frame: () => undefined, connected: () => undefined }, (u) => (urls.push(u), new Fake() as unknown as WebSocket));
    c.open({ do: "draw", size: [4, 3] });
    expect(JSON.parse(new URL(urls[0]).searchParams.get("say")!)).toEqual({ do: "draw", size: [4, 3], n: 1 });
    expect(new URL(urls[0]).searchParams.get("open")).toBe("a");
    expect(c.asksAtOnce).toBe(true);
    last().accept();
    expect(c.send({ do: "probe" })).toBe(2);
    last().close();
    vi.advanceTimersByTime(600);
    expect(urls[1]).toBe("ws://x/socket?open=a");
    expect(c.asksAtOnce).toBe(false);
    c.close();
  });

  it("counts requests and gives answers to those who asked", async () => {
    const a = c.ask({ do: "probe" });
    const b = c.ask({ do: "rows" });
    expect(last().sent.map((m) => m.n)).toEqual([1, 2]);
    last().say({ is: "rows", n: 2 });
    last().say({ is: "probe", n: 1 });
    expect((await a).is).toBe("probe");
    expect((await b).is).toBe("rows");
    expect(messages).toEqual([]);
  });

  it("rejects what is refused, unanswered, or cut off", async () => {
    const a = c.ask({ do: "probe" });
    last().say({ is: "refused", n: 1, errors: [{ at: "", word: "", text: "no such view" }] });
    await expect(a).rejects.toThrow("no such view");
    const b = c.ask({ do: "rows" }, 5);
    vi.advanceTimersByTime(5001);
    await expect(b).rejects.toThrow("No answer");
    const d = c.ask({ do: "line" });
    last().close();
    await expect(d).rejects.toThrow("lost");
    await expect(c.ask({ do: "line" })).rejects.toThrow("Not connected");
  });

  it("connects again with pauses that grow to a quarter of a minute, and from half a second after success", () => {
    const pauses: number[] = [];
    for (let i = 0; i < 8; i++) {
      const count = Fake.made.length;
      last().close();
      let waited = 0;
      while (Fake.made.length === count) {
        vi.advanceTimersByTime(100);
        waited += 100;
      }
      pauses.push(waited);
    }
    expect(pauses).toEqual([500, 1000, 2000, 4000, 8000, 15000, 15000, 15000]);
    last().accept();
    const count = Fake.made.length;
    last().close();
    vi.advanceTimersByTime(500);
    expect(Fake.made.length).toBe(count + 1);
    expect(how.filter((h) => h === "lost").length).toBe(9);
  });
});
