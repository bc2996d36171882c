// The studio in a cell of a notebook: frames travel over the widget's own channel.

import { mount } from "./app";
import { Signal } from "./core/signal";
import type { Status, Transport } from "./transport/transport";

interface Model {
  send: (content: unknown, callbacks?: unknown, buffers?: ArrayBuffer[]) => void;
  on: (event: string, listener: (content: { frame?: boolean }, buffers: DataView[]) => void) => void;
  off: (event: string, listener?: unknown) => void;
  get: (name: string) => unknown;
}

class WidgetTransport implements Transport {
  readonly status = new Signal<Status>("open");
  onMessage: (data: ArrayBuffer) => void = () => undefined;
  private readonly listener = (_: { frame?: boolean }, buffers: DataView[]): void => {
    const view = buffers[0];
    if (view) this.onMessage(new Uint8Array(view.buffer, view.byteOffset, view.byteLength).slice().buffer);
  };

  constructor(private readonly model: Model) {
    model.on("msg:custom", this.listener);
  }

  send(bytes: Uint8Array<ArrayBuffer>): void {
    this.model.send({ frame: true }, undefined, [bytes.buffer]);
  }

  close(): void {
    this.model.off("msg:custom", this.listener);
  }
}

function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const box = document.createElement("div");
  box.style.height = `${Number(model.get("height"))}px`;
  el.append(box);
  const app = mount(box, new WidgetTransport(model));
  model.send({ hello: true });
  return () => app.close();
}

export default { render };
