// Sliders of a model's coefficients: the first ones, more on demand; they preview while they are dragged.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, numberField, setNumber, slider } from "../../panels/controls";
import type { Studio } from "../../studio";
import { LayerDrag } from "../layer_drag";
import type { ModelState } from "./model_state";

const FIRST = 6;
const REACH = 3; // standard deviations

export class CoefficientSliders {
  readonly element = h("div", { class: "coefficients" });
  private shown = FIRST;
  private drag: LayerDrag | null = null;

  constructor(private readonly studio: Studio) {}

  get dragging(): boolean {
    return this.drag !== null;
  }

  show(model: ModelState): void {
    if (this.drag) return;
    const count = Math.min(this.shown, model.count);
    const change = (to: number): void => {
      this.shown = to;
      this.show(model);
    };
    const focused = this.element.contains(document.activeElement) ? document.activeElement?.getAttribute("aria-label") : null;
    replace(
      this.element,
      ...Array.from({ length: count }, (_, i) => this.row(model, i)),
      h(
        "div",
        { class: "button-row" },
        count < model.count && button(t("moreCoefficients"), () => change(2 * this.shown), { kind: "quiet" }),
        this.shown > FIRST && button(t("fewerCoefficients"), () => change(FIRST), { kind: "quiet" }),
      ),
    );
    if (focused) this.element.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus();
  }

  private row(model: ModelState, index: number): HTMLElement {
    const label = `${t("coefficient")} ${model.label(index)}`;
    const set = (value: number): void => {
      model.coefficients[index] = value;
      void this.studio.ask("model.coefficients", { layer: model.layer }, { coefficients: model.coefficients.slice() });
    };
    const entry = numberField(rounded(model.coefficients[index]!), set, { label, step: 0.1 });
    const control = slider(model.coefficients[index]!, {
      label: `${label} –`,
      low: -REACH,
      high: REACH,
      step: 0.01,
      oninput: (value) => {
        this.drag ??= new LayerDrag(this.studio, "model", { layer: model.layer, label: "coefficients" });
        model.coefficients[index] = value;
        this.drag.move({}, { coefficients: model.coefficients.slice() });
        setNumber(entry, rounded(value));
      },
      ondone: () => void this.finish(),
    });
    control.addEventListener("dblclick", () => set(0));
    const share = `${(100 * model.share(index)).toPrecision(2)} %`;
    return h(
      "div",
      { class: "coefficient", title: `${t("variance")}: ${share}` },
      h("span", { class: "coefficient-name" }, model.label(index)),
      control,
      entry,
    );
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.drag = null;
    await drag?.commit();
  }
}

const rounded = (value: number): number => Number(value.toFixed(2));
