// The server's session, seen from here: requests that are answered, events that arrive, the state they leave.

import { Signal } from "../core/signal";
import { decode, encode, type Frame, type Numbers } from "./frame";
import type { Catalogue, SceneState } from "./protocol";
import type { Status, Transport } from "./transport";

export class CommandError extends Error {
  constructor(
    readonly kind: string,
    message: string,
  ) {
    super(message);
  }
}

interface Pending {
  resolve: (answer: Frame) => void;
  reject: (error: Error) => void;
}

type Listener = (frame: Frame) => void;

export class Session {
  readonly scene = new Signal<SceneState | null>(null);
  readonly catalogue = new Signal<Catalogue | null>(null);
  readonly status: Signal<Status>;
  private readonly pending = new Map<number, Pending>();
  private readonly listeners = new Map<string, Set<Listener>>();
  private lastId = 0;

  constructor(private readonly transport: Transport) {
    this.status = transport.status;
    transport.onMessage = (data) => this.receive(data);
    transport.status.onChange((status) => {
      if (status !== "open") this.abandon();
    });
  }

  /** Ask for a command and wait for its answer. */
  ask(command: string, values: Record<string, unknown> = {}, arrays: Record<string, Numbers> = {}): Promise<Frame> {
    if (this.status.value !== "open") return Promise.reject(new CommandError("Disconnected", ""));
    const id = ++this.lastId;
    const answer = new Promise<Frame>((resolve, reject) => this.pending.set(id, { resolve, reject }));
    this.transport.send(encode({ head: { id, do: command, with: values }, arrays }));
    return answer;
  }

  /** Listen to an event; gives what ends that. */
  on(event: string, listener: Listener): () => void {
    const set = this.listeners.get(event) ?? new Set();
    set.add(listener);
    this.listeners.set(event, set);
    return () => set.delete(listener);
  }

  close(): void {
    this.transport.close();
  }

  private receive(data: ArrayBuffer): void {
    const frame = decode(data);
    const { answer, event } = frame.head as { answer?: number; event?: string };
    if (answer !== undefined) this.settle(answer, frame);
    else if (event !== undefined) this.take(event, frame);
  }

  private settle(id: number, frame: Frame): void {
    const waiting = this.pending.get(id);
    this.pending.delete(id);
    const error = frame.head["error"] as { kind: string; message: string } | undefined;
    if (error) waiting?.reject(new CommandError(error.kind, error.message));
    else waiting?.resolve(frame);
  }

  private take(event: string, frame: Frame): void {
    if (event === "hello") this.catalogue.set(frame.head["catalogue"] as Catalogue);
    if (event === "scene") this.scene.set(frame.head["scene"] as SceneState);
    for (const listener of this.listeners.get(event) ?? []) listener(frame);
  }

  private abandon(): void {
    for (const { reject } of this.pending.values()) reject(new CommandError("Disconnected", ""));
    this.pending.clear();
  }
}
