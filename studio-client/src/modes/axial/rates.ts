// Turns and growth of each segment of an axis as bars: drag them, or draw across them.

import { h, replace } from "../../core/dom";
import { t, type StringKey } from "../../core/strings";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { LayerDrag } from "../layer_drag";

const SVG = "http://www.w3.org/2000/svg";
const [WIDE, HIGH] = [180, 34];
const DEGREES = 180 / Math.PI;

/** What a row is called, and the number at its top. */
const ROWS: readonly (readonly [StringKey, number, (value: number) => string])[] = [
  ["rateAcross", Math.PI / 3, (value) => `${Math.round(value * DEGREES)}°`],
  ["rateAside", Math.PI / 3, (value) => `${Math.round(value * DEGREES)}°`],
  ["rateTwist", Math.PI / 3, (value) => `${Math.round(value * DEGREES)}°`],
  ["rateGrowth", 0.95, (value) => `${Math.round(value * 100)} %`],
];

/** The bars of a layer whose axis is cut into segments. */
export function ratesPanel(studio: Studio, layer: Layer): HTMLElement {
  const body = h("div", { class: "rates" });
  void studio.ask("axial.get", { layer: layer.name }).then((answer) => {
    const rates = answer?.arrays["rates"];
    if (rates) replace(body, ...ROWS.map((_, column) => new RateRow(studio, layer.name, Float64Array.from(rates), column).element));
  });
  return body;
}

class RateRow {
  readonly element: HTMLElement;
  private readonly bars: SVGRectElement[];
  private readonly said = h("output");
  private drag: LayerDrag | null = null;
  /** The bar that the pointer was at before, and how high. */
  private last: readonly [number, number] | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly layer: string,
    private readonly rates: Float64Array,
    private readonly column: number,
  ) {
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${WIDE} ${HIGH}`);
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("role", "img");
    svg.setAttribute("aria-label", t(ROWS[column]![0]));
    this.bars = Array.from({ length: this.count }, () => svg.appendChild(document.createElementNS(SVG, "rect")));
    svg.addEventListener("pointerdown", (event) => this.hold(svg, event));
    svg.addEventListener("pointermove", (event) => this.drag && this.set(svg, event));
    svg.addEventListener("pointerup", () => this.release());
    svg.addEventListener("pointercancel", () => this.release());
    this.element = h("div", { class: "rate-row" }, h("span", { class: "row-label" }, t(ROWS[column]![0])), svg as unknown as Node, this.said);
    this.show();
  }

  private get count(): number {
    return this.rates.length / 4;
  }

  private at(segment: number): number {
    return this.rates[4 * segment + this.column]!;
  }

  private hold(svg: SVGSVGElement, event: PointerEvent): void {
    if (event.button !== 0) return;
    svg.setPointerCapture(event.pointerId);
    this.drag = new LayerDrag(this.studio, "preview", { layer: this.layer, label: "field" });
    this.set(svg, event);
  }

  /** The bar under the pointer ends there, and those that it has passed on a line; near the middle they are nothing. */
  private set(svg: SVGSVGElement, event: PointerEvent): void {
    const { left, top, width, height } = svg.getBoundingClientRect();
    const to = Math.min(Math.max(Math.floor(((event.clientX - left) / width) * this.count), 0), this.count - 1);
    const high = Math.min(Math.max(1 - (2 * (event.clientY - top)) / height, -1), 1);
    const [from, before] = this.last ?? [to, high];
    for (let i = 0; i <= Math.abs(to - from); i++) {
      const part = high + ((before - high) * i) / Math.max(Math.abs(to - from), 1);
      this.rates[4 * (to + Math.sign(from - to) * i) + this.column] = Math.abs(part) < 0.08 ? 0 : part * ROWS[this.column]![1];
    }
    this.last = [to, high];
    this.show(to);
    const rates = Array.from({ length: this.count }, (_, i) => [...this.rates.subarray(4 * i, 4 * i + 4)]);
    this.drag?.move({ fields: { rates } }, {});
  }

  private release(): void {
    void this.drag?.commit();
    this.drag = this.last = null;
  }

  private show(segment: number | null = null): void {
    const [, top, words] = ROWS[this.column]!;
    this.bars.forEach((bar, i) => {
      const high = Math.min(Math.max(this.at(i) / top, -1), 1) * (HIGH / 2 - 1);
      bar.setAttribute("x", String((i * WIDE) / this.count + 1));
      bar.setAttribute("width", String(Math.max(WIDE / this.count - 2, 0.5)));
      bar.setAttribute("y", String(HIGH / 2 - Math.max(high, 0) - 0.5));
      bar.setAttribute("height", String(Math.abs(high) + 1));
    });
    const sum = Array.from({ length: this.count }, (_, i) => this.at(i)).reduce((a, b) => a + b, 0);
    const mean = this.column === 3 ? sum / this.count : sum;
    this.said.textContent = words(segment === null ? mean : this.at(segment));
    this.said.title = t(this.column === 3 ? "rateMean" : "rateSum");
  }
}
