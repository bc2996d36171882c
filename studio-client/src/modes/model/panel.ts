// The mode's section of the inspector: coefficients, landmarks, the target of a fit, a random field.

import { h, replace } from "../../core/dom";
import { icon } from "../../core/icons";
import { pickFiles } from "../../core/files";
import { t } from "../../core/strings";
import { button, checkbox, numberField, row } from "../../panels/controls";
import type { Studio } from "../../studio";
import { buildModel } from "./build_dialog";
import type { ModelState } from "./model_state";
import type { RandomFieldPanel } from "./random_field";
import type { CoefficientSliders } from "./sliders";
import type { FitTarget } from "./target";

export interface ModelActions {
  release: (all: boolean) => void;
  uncertainty: (on: boolean) => void;
}

interface Parts {
  sliders: CoefficientSliders;
  target: FitTarget;
  field: RandomFieldPanel;
}

export class ModelPanel {
  readonly element = h("div", { class: "model-panel" });

  constructor(
    private readonly studio: Studio,
    private readonly parts: Parts,
    private readonly actions: ModelActions,
  ) {}

  show(model: ModelState | null, selected: number, uncertainty: boolean): void {
    const { sliders, target, field } = this.parts;
    if (!model) {
      replace(this.element, this.start(), group(t("randomFieldTitle"), field.build()));
      return;
    }
    sliders.show(model);
    replace(
      this.element,
      h("p", { class: "selection-title" }, `${model.rank} ${t("fieldsCount")}, ${model.count} ${t("coefficientsCount")}`),
      sliders.element,
      this.chance(model),
      group(t("landmarks"), this.landmarks(model, selected, uncertainty)),
      group(t("fit"), target.build()),
      group(t("randomFieldTitle"), field.build()),
    );
  }

  private start(): HTMLElement {
    return h(
      "div",
      { class: "empty" },
      icon("model", 28) as unknown as Node,
      h("p", null, t("noModel")),
      button(t("buildModel"), () => buildModel(this.studio, this.parts.field.kernel), { kind: "primary", icon: "plus" }),
      button(t("openModel"), () => pickFiles((files) => this.studio.take(files)), { icon: "open" }),
    );
  }

  private chance(model: ModelState): HTMLElement {
    const { studio } = this;
    const layer = model.layer;
    const zeros = (): void => void studio.ask("model.coefficients", { layer }, { coefficients: new Float64Array(model.count) });
    const sample = (): void => void studio.ask("model.sample", { layer, seed: Math.floor(Math.random() * 1e9) });
    return h(
      "div",
      { class: "button-row" },
      button(t("randomSample"), sample, { icon: "dice" }),
      button(t("resetCoefficients"), zeros, { icon: "reset" }),
    );
  }

  private landmarks(model: ModelState, selected: number, uncertainty: boolean): HTMLElement {
    const { studio, actions } = this;
    if (!model.landmarks) return h("p", { class: "muted" }, t("noLandmarks"));
    const setNoise = (noise: number): void => void studio.ask("model.noise", { layer: model.layer, noise });
    return h(
      "div",
      null,
      checkbox(t("showUncertainty"), uncertainty, actions.uncertainty),
      row(t("landmarkNoise"), numberField(Number(model.noise.toPrecision(3)), setNoise, { label: t("landmarkNoise"), low: 1e-12, step: model.noise })),
      h(
        "div",
        { class: "button-row" },
        selected > 0 && button(t("releaseSelected"), () => actions.release(false), { icon: "trash" }),
        button(t("releaseAll"), () => actions.release(true)),
      ),
    );
  }
}

const group = (title: string, body: HTMLElement): HTMLElement =>
  h("div", { class: "model-group" }, h("h4", null, title), body);
