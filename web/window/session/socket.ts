// SPDX-License-Identifier: Apache-2.0
// The connection to the server: numbered requests, answers by number, and reconnecting with growing pauses.
import { splitFrame, type FrameHeader, type ServerMessage } from "../protocol";

export type Connected = "connecting" | "open" | "lost";

export interface Handlers {
  message: (message: ServerMessage) => void;
  frame: (header: FrameHeader, picture: Uint8Array) => void;
  connected: (how: Connected) => void;
}

export type Request = { do: string } & Record<string, unknown>;

/** An answer that says no, with what the server objects to. */
export class Refused extends Error {}

interface Waiting {
  resolve: (message: ServerMessage) => void;
  reject: (error: Error) => void;
  timer: ReturnType<typeof setTimeout>;
}

export class Connection {
  private socket: WebSocket | null = null;
  private last = 0;
  private tries = 0;
  /** The socket that is open, or being opened, has asked for a picture with its address. */
  asksAtOnce = false;
  private waiting = new Map<number, Waiting>();
  private closed = false;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
    private readonly make: (url: string) => WebSocket = (u) => new WebSocket(u),
  ) {}

  /** `first`: goes with the address as request 1, so that the server need not wait for the socket to be open. */
  open(first?: Request): void {
    this.handlers.connected("connecting");
    this.asksAtOnce = first !== undefined;
    let url = this.url;
    if (first) url += `${url.includes("?") ? "&" : "?"}say=${encodeURIComponent(JSON.stringify({ ...first, n: (this.last = 1) }))}`;
    const socket = this.make(url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.tries = 0;
      this.handlers.connected("open");
    };
    socket.onmessage = (event) => this.received(event.data as string | ArrayBuffer);
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.forget("The connection to the server was lost");
      if (this.closed) return;
      this.handlers.connected("lost");
      // Half a second, doubled up to 15: a server that restarts is met soon, one that is gone is not hammered.
      setTimeout(() => this.open(), Math.min(15000, 500 * 2 ** this.tries++));
    };
  }

  close(): void {
    this.closed = true;
    this.socket?.close();
  }

  get isOpen(): boolean {
    return this.socket !== null && this.socket.readyState === 1;
  }

  /** The last number that was sent. */
  get number(): number {
    return this.last;
  }

  /** Sends a request and returns its number, or 0 while there is no connection. */
  send(request: Request): number {
    if (!this.isOpen) return 0;
    const n = ++this.last;
    this.socket!.send(JSON.stringify({ ...request, n }));
    return n;
  }

  /** Acknowledgements and cursors carry no number of their own. */
  tell(message: Request): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(message));
  }

  ask<T extends ServerMessage>(request: Request, seconds = 20): Promise<T> {
    const n = this.send(request);
    if (n === 0) return Promise.reject(new Error("Not connected"));
    return new Promise<T>((resolve, reject) => {
      const timer = setTimeout(() => {
        this.waiting.delete(n);
        reject(new Error(`No answer to '${request.do}' after ${seconds} s`));
      }, seconds * 1000);
      this.waiting.set(n, { resolve: resolve as (m: ServerMessage) => void, reject, timer });
    });
  }

  private received(data: string | ArrayBuffer): void {
    if (typeof data !== "string") {
      const { header, picture } = splitFrame(data);
      this.handlers.frame(header, picture);
      return;
    }
    const message = JSON.parse(data) as ServerMessage;
    // The answer to what changes the session is its next state.
    const n = "n" in message ? message.n : message.is === "state" ? (message.by ?? 0) : 0;
    const waiting = this.waiting.get(n);
    if (waiting) {
      this.waiting.delete(n);
      clearTimeout(waiting.timer);
      if (message.is === "refused") waiting.reject(new Refused(message.errors.map((e) => e.text).join("; ") || "Refused"));
      else waiting.resolve(message);
      if (message.is !== "state") return;
    }
    this.handlers.message(message);
  }

  private forget(reason: string): void {
    for (const { reject, timer } of this.waiting.values()) {
      clearTimeout(timer);
      reject(new Error(reason));
    }
    this.waiting.clear();
  }
}
