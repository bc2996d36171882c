// What carries frames: a WebSocket, or the channel of a notebook's widget.

import { Signal } from "../core/signal";

export type Status = "connecting" | "open" | "lost" | "refused";

export interface Transport {
  readonly status: Signal<Status>;
  onMessage: (data: ArrayBuffer) => void;
  send(bytes: Uint8Array<ArrayBuffer>): void;
  close(): void;
}
