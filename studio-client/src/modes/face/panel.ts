// The mode's section of the inspector: a photograph to begin with, then the caricature.

import { h, replace } from "../../core/dom";
import { pickFiles } from "../../core/files";
import { icon } from "../../core/icons";
import { t } from "../../core/strings";
import { button, checkbox, iconButton } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { CaricatureSliders, FEATURES } from "./sliders";

export interface FaceFacts {
  /** What is missing for looking at photographs; empty where nothing is. */
  missing: string;
  example: boolean;
  /** Which face of the photograph, and of how many. */
  number: number;
  count: number;
  least: number;
  folds: boolean;
}

export interface FaceActions {
  landmarks: (on: boolean) => void;
  handles: () => void;
}

export class FacePanel {
  readonly element = h("div", { class: "face-panel" });
  readonly sliders: CaricatureSliders;

  constructor(
    private readonly studio: Studio,
    private readonly actions: FaceActions,
  ) {
    this.sliders = new CaricatureSliders(studio);
  }

  show(layer: Layer | null, facts: FaceFacts, landmarks: boolean): void {
    if (this.sliders.dragging) return;
    if (!layer) {
      replace(this.element, this.start(facts));
      return;
    }
    this.sliders.show(layer);
    replace(
      this.element,
      facts.count > 1 && this.others(facts),
      this.sliders.element,
      this.foldLine(layer, facts),
      h(
        "div",
        { class: "button-row" },
        button(t("resetCaricature"), () => void this.reset(layer), { icon: "reset" }),
        button(t("faceHandles"), () => this.actions.handles(), { icon: "points" }),
      ),
      checkbox(t("faceLandmarks"), landmarks, this.actions.landmarks),
      h("div", { class: "button-row" }, button(t("anotherPhotograph"), () => this.choose(), { icon: "camera" })),
    );
  }

  private start({ missing, example }: FaceFacts): HTMLElement {
    const { studio } = this;
    return h(
      "div",
      { class: "empty" },
      icon("face", 28) as unknown as Node,
      h("p", null, t("noFace")),
      missing && h("p", { class: "missing" }, missing),
      !missing && button(t("choosePhotograph"), () => this.choose(), { kind: "primary", icon: "camera" }),
      !missing && example && button(t("exampleFace"), () => void studio.ask("face.open"), { kind: "quiet" }),
    );
  }

  private choose(): void {
    pickFiles((files) => this.studio.take(files));
  }

  private others({ number, count }: FaceFacts): HTMLElement {
    const go = (to: number): void => void this.studio.ask("face.other", { number: (to + count) % count });
    const next = iconButton("chevron", t("nextFace"), () => go(number + 1));
    return h("div", { class: "row" }, h("span", { class: "row-label" }, `${t("faceNumber")} ${number + 1} / ${count}`), next);
  }

  private foldLine(layer: Layer, { folds, least }: FaceFacts): HTMLElement | null {
    const amount = Number(layer.fields.find((field) => field.name === "amount")?.value ?? 0);
    if (amount === 0) return null;
    const text = folds ? t("faceFolds") : `${t("faceFoldFree")}: det J ≥ ${least.toFixed(2)}`;
    return h(
      "div",
      { class: `fold ${folds ? "folds" : "fold-free"}` },
      icon(folds ? "warning" : "check", 16) as unknown as Node,
      h("span", null, text),
      folds && button(t("limitFold"), () => void this.studio.ask("face.reduce", { layer: layer.name }), { kind: "quiet" }),
    );
  }

  private reset(layer: Layer): Promise<unknown> {
    const fields = { amount: 0, expression: 0, ...Object.fromEntries(FEATURES.map((name) => [name, 1])) };
    return this.studio.ask("layers.fields", { layer: layer.name, fields });
  }
}
