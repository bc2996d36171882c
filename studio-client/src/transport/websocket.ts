// Frames over a WebSocket that comes back by itself when it is lost.

import { Signal } from "../core/signal";
import type { Status, Transport } from "./transport";

const FIRST_WAIT = 300;
const LONGEST_WAIT = 5000;

export class WebSocketTransport implements Transport {
  readonly status = new Signal<Status>("connecting");
  onMessage: (data: ArrayBuffer) => void = () => undefined;
  private socket: WebSocket | null = null;
  private wait = FIRST_WAIT;
  private closed = false;

  constructor(private readonly address: string) {
    this.connect();
  }

  send(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes);
  }

  close(): void {
    this.closed = true;
    this.socket?.close();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
      this.status.set("open");
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.onMessage(event.data);
    socket.onclose = () => {
      if (this.closed) return;
      void this.explainLoss();
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(this.wait * 1.6, LONGEST_WAIT);
    };
  }

  /** A server that was started anew answers, but does not know this page any more. */
  private async explainLoss(): Promise<void> {
    this.status.set("lost");
    try {
      const answer = await fetch("alive", { cache: "no-store" });
      if (answer.status === 401 || answer.status === 403) this.status.set("refused");
    } catch {
      // nobody answers: still lost
    }
  }
}
