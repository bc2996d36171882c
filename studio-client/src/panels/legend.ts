// What the colours mean: the very table that the surface is painted with, and numbers beside it.

import { h, replace } from "../core/dom";
import { shortNumber } from "./controls";

const STEPS = 5;

export class Legend {
  readonly element = h("div", { class: "legend", hidden: true });

  show(title: string, unit: string, low: number, high: number, table: Uint8Array): void {
    const bar = h("canvas", { class: "legend-bar", width: 1, height: 256 });
    const context = bar.getContext("2d");
    const picture = context?.createImageData(1, 256);
    if (context && picture) {
      for (let i = 0; i < 256; i++) picture.data.set(table.subarray(4 * (255 - i), 4 * (255 - i) + 4), 4 * i);
      context.putImageData(picture, 0, 0);
    }
    const ticks = Array.from({ length: STEPS }, (_, i) => high - ((high - low) * i) / (STEPS - 1));
    replace(
      this.element,
      h("div", { class: "legend-title" }, title),
      unit && h("div", { class: "muted" }, unit),
      h("div", { class: "legend-scale" }, bar, h("div", { class: "legend-ticks" }, ...ticks.map((value) => h("span", null, rounded(value, high - low))))),
    );
  }
}

function rounded(value: number, span: number): string {
  const digits = Math.max(0, Math.min(6, 2 - Math.floor(Math.log10(span || 1))));
  return Math.abs(span) > 1e-5 && Math.abs(value) < 1e7 ? value.toFixed(digits) : shortNumber(value);
}
