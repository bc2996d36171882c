// A rectangle that is drawn on the canvas to select what lies in it.

import { h } from "../core/dom";
import type { Pointer } from "./mode";

export interface Rectangle {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

export class SelectionFrame {
  readonly element = h("div", { class: "selection-frame", hidden: true });
  private from: Pointer | null = null;

  get drawing(): boolean {
    return this.from !== null;
  }

  begin(pointer: Pointer): void {
    this.from = pointer;
  }

  stretch(pointer: Pointer): void {
    const { left, top, right, bottom } = this.until(pointer);
    this.element.hidden = false;
    Object.assign(this.element.style, {
      left: `${left}px`,
      top: `${top}px`,
      width: `${right - left}px`,
      height: `${bottom - top}px`,
    });
  }

  /** The rectangle, and whether Shift was held where it began. */
  end(pointer: Pointer): Rectangle & { shift: boolean } {
    const found = { ...this.until(pointer), shift: this.from!.shift };
    this.from = null;
    this.element.hidden = true;
    return found;
  }

  private until({ x, y }: Pointer): Rectangle {
    const from = this.from!;
    return { left: Math.min(from.x, x), top: Math.min(from.y, y), right: Math.max(from.x, x), bottom: Math.max(from.y, y) };
  }
}
