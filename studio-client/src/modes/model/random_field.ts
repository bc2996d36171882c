// Arrows of a random field: what a Gaussian process with a kernel of this width does to the shape.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, checkbox, row, slider } from "../../panels/controls";
import type { Studio } from "../../studio";
import { Latest } from "../../transport/latest";
import { withAlpha } from "../../view/color_map";
import { FieldView } from "../../view/field_view";
import { buildModel, type KernelChoice } from "./build_dialog";

export class RandomFieldPanel {
  readonly element = h("div", { class: "random-field" });
  /** As parts of the shape's diagonal. */
  private sigma = 0.2;
  private scale = 0.06;
  private seed = 2;
  private on = false;
  private arrows: FieldView | null = null;
  private readonly latest = new Latest<null>(() => this.fetch());

  constructor(private readonly studio: Studio) {}

  /** The kernel in the shape's unit of length. */
  get kernel(): KernelChoice {
    const size = this.studio.scene?.mesh?.diagonal ?? 1;
    return { sigma: Number((this.sigma * size).toPrecision(3)), scale: Number((this.scale * size).toPrecision(3)) };
  }

  get shown(): boolean {
    return this.on;
  }

  get facts(): KernelChoice & { seed: number } {
    return { ...this.kernel, seed: this.seed };
  }

  enter(): void {
    this.arrows = new FieldView();
    this.studio.viewport.helpers.add(this.arrows.object);
    this.refresh();
  }

  leave(): void {
    if (!this.arrows) return;
    this.arrows.setArrows(null, new Float32Array(), 1, []);
    this.studio.viewport.helpers.remove(this.arrows.object);
    this.arrows = null;
  }

  build(): HTMLElement {
    const percent = (value: number): string => `${Math.round(100 * value)} %`;
    const details = h("div", { class: "indented", hidden: !this.on });
    replace(
      details,
      row(t("kernelSigma"), slider(this.sigma, { label: t("kernelSigma"), low: 0.02, high: 1, step: 0.01, text: percent, oninput: (sigma) => this.change({ sigma }) })),
      row(t("kernelScale"), slider(this.scale, { label: t("kernelScale"), low: 0.005, high: 0.25, step: 0.005, text: (v) => `${(100 * v).toFixed(1)} %`, oninput: (scale) => this.change({ scale }) })),
      h(
        "div",
        { class: "button-row" },
        button(t("otherField"), () => this.change({ seed: this.seed + 1 }), { icon: "dice" }),
        button(t("modelOfField"), () => buildModel(this.studio, this.kernel)),
      ),
    );
    replace(
      this.element,
      checkbox(t("randomField"), this.on, (on) => {
        this.on = on;
        details.hidden = !on;
        this.refresh();
      }),
      details,
    );
    return this.element;
  }

  refresh(): void {
    this.latest.push(null);
  }

  private change(part: { sigma?: number; scale?: number; seed?: number }): void {
    Object.assign(this, part);
    this.refresh();
  }

  private async fetch(): Promise<void> {
    const { studio, arrows } = this;
    if (!arrows || !studio.scene?.mesh) return;
    const answer = this.on ? await studio.ask("model.field", { ...this.facts }) : null;
    if (this.arrows !== arrows) return;
    const table = answer?.arrays["table"] as Uint8Array | undefined;
    arrows.setArrows(
      (answer?.arrays["positions"] as Float32Array | undefined) ?? null,
      (answer?.arrays["vectors"] as Float32Array | undefined) ?? new Float32Array(),
      studio.scene.mesh.diagonal / 260,
      table ? withAlpha(table) : [],
    );
    studio.viewport.request();
  }
}
