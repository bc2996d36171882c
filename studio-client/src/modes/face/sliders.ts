// Sliders of a caricature: how much of it, and how much of each feature; they preview while they are dragged.

import { h, replace } from "../../core/dom";
import { t, tWord } from "../../core/strings";
import { numberField, setNumber, slider } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { FieldValue, Layer } from "../../transport/protocol";
import { LayerDrag } from "../layer_drag";

export const FEATURES = ["brows", "eyes", "nose", "mouth", "chin", "cheeks", "outline"] as const;

interface Reach {
  low: number;
  high: number;
}

const REACHES: Record<string, Reach> = { amount: { low: -1, high: 2 }, expression: { low: 0, high: 1 } };
const GAIN: Reach = { low: 0, high: 2 };

export class CaricatureSliders {
  readonly element = h("div", { class: "caricature" });
  private drag: LayerDrag | null = null;
  private shown = "";

  constructor(private readonly studio: Studio) {}

  get dragging(): boolean {
    return this.drag !== null;
  }

  show(layer: Layer): void {
    if (this.drag) return;
    const field = (name: string): FieldValue | undefined => layer.fields.find((each) => each.name === name);
    const values = ["amount", ...FEATURES, "expression"].map((name) => field(name)?.value);
    const key = JSON.stringify([layer.name, values, this.studio.settings.now.language]);
    if (key === this.shown) return;
    this.shown = key;
    const row = (name: string, master = false): HTMLElement => this.row(layer, name, Number(field(name)?.value ?? 0), master);
    replace(
      this.element,
      row("amount", true),
      h("h4", null, t("faceFeatures")),
      ...FEATURES.map((name) => row(name)),
      h("h4", null, t("faceExpression")),
      row("expression"),
    );
  }

  private row(layer: Layer, name: string, value: number, master: boolean): HTMLElement {
    const label = tWord("face_", name);
    const { low, high } = REACHES[name] ?? GAIN;
    const set = (next: number): void => {
      void this.studio.ask("layers.fields", { layer: layer.name, fields: { [name]: next } });
    };
    const entry = numberField(rounded(value), set, { label, step: 0.1 });
    const control = slider(value, {
      label: `${label} –`,
      low: Math.min(low, value),
      high: Math.max(high, value),
      step: 0.01,
      oninput: (next) => {
        this.drag ??= new LayerDrag(this.studio, "preview", { layer: layer.name, label: "caricature" });
        this.drag.move({ fields: { [name]: next } }, {});
        setNumber(entry, rounded(next));
      },
      ondone: () => void this.finish(),
    });
    control.addEventListener("dblclick", () => set(name === "amount" || name === "expression" ? 0 : 1));
    return h("div", { class: master ? "feature master" : "feature" }, h("span", { class: "feature-name" }, label), control, entry);
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.drag = null;
    this.shown = "";
    await drag?.commit();
  }
}

const rounded = (value: number): number => Number(value.toFixed(2));
