// What the inspector says of surface editing: what is picked, by which method, named selections, the skeleton.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, checkbox, iconButton, numberField, row, segments } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { Convergence } from "./convergence";
import type { MethodSwitch } from "./method_switch";
import type { Part, Region } from "./region";
import type { SkeletonChoice, SkeletonShow, Where } from "./skeleton_show";
import { METHODS, type Method, type SurfaceToolbar } from "./tools";

export interface SurfaceActions {
  grow: (rings: number) => void;
  clear: () => void;
  keep: (name: string) => void;
  forget: (name: string) => void;
  recall: (name: string, part: Part) => void;
  method: (method: Method) => void;
  /** Give what is picked to the active layer; or take the layer's own back. */
  give: () => void;
  back: () => void;
  skeleton: (part: Partial<SkeletonChoice>) => void;
  mesh: (shown: boolean) => void;
}

/** Whose it is that is picked. */
export interface Whose {
  /** A layer's; null where it is nobody's yet, and then the layer that could take it. */
  own: string | null;
  other: string | null;
  /** Whether the layer does nothing now. */
  unseen: boolean;
  /** Whether the handle will tear off from what stays. */
  torn: boolean;
}

export class SurfacePanel {
  readonly element = h("div", { class: "surface-panel" });
  private readonly numbers = { region: h("strong"), handle: h("strong") };

  constructor(
    private readonly studio: Studio,
    private readonly tools: SurfaceToolbar,
    private readonly skeleton: SkeletonShow,
    private readonly convergence: Convergence,
    private readonly switching: MethodSwitch,
    private readonly actions: SurfaceActions,
  ) {}

  /** What is picked, and whose it is. */
  show(region: Region, whose: Whose): void {
    const typed = this.element.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement;
    if (typed && document.activeElement!.getAttribute("aria-label") === t("selectionName")) return;
    if (!this.studio.scene?.mesh?.faces) {
      replace(this.element, h("p", { class: "muted" }, t("needsFaces")));
      return;
    }
    replace(
      this.element,
      this.counts(),
      h(
        "div",
        { class: "button-row" },
        iconButton("plus", `${t("grow")} (+)`, () => this.actions.grow(1)),
        iconButton("minus", `${t("shrink")} (−)`, () => this.actions.grow(-1)),
        button(t("clear"), () => this.actions.clear()),
      ),
      row(t("method"), segments(METHODS.map(([name, title]) => [name, t(title)] as const), this.tools.now.method, this.actions.method)),
      this.switching.waits && h("p", { class: "muted", role: "status" }, t("methodComing")),
      this.convergence.element,
      ...this.next(region, whose),
      h("h4", null, t("namedSelections")),
      this.named(),
      h("h4", null, t("skeleton")),
      this.skeletonRows(),
    );
  }

  /** How much is picked, also while it is being picked. */
  count(region: Region): void {
    for (const part of ["region", "handle"] as const) this.numbers[part].textContent = grouped(region.count(part));
  }

  private counts(): HTMLElement {
    const line = (part: Part, label: string): HTMLElement =>
      h("p", { class: `mark-count ${part}` }, h("i"), h("span", null, label), this.numbers[part]);
    return h("div", { class: "mark-counts" }, line("region", t("region")), line("handle", t("handlePart")));
  }

  /** What there is to do next, and whose it will be. */
  private next(region: Region, { own, other, unseen, torn }: Whose): HTMLElement[] {
    const says = (text: string): HTMLElement => h("p", { class: "muted" }, text);
    if (own !== null) return [says(unseen ? `«${own}» ${t("layerUnseen")}` : `${t("dragsLayer")} «${own}»`)];
    const missing = !region.count("region") ? "firstRegion" : !region.count("handle") ? "thenHandle" : null;
    return [says(t(missing ?? (torn ? "handleTears" : "dragMakesLayer"))), ...(other === null ? [] : [this.choice(other, missing === null)])];
  }

  /** Give what is picked to a layer, or take the layer's own back. */
  private choice(layer: string, whole: boolean): HTMLElement {
    return h(
      "div",
      { class: "button-row" },
      whole && button(`${t("giveTo")} «${layer}»`, () => this.actions.give()),
      button(`${t("back")} «${layer}»`, () => this.actions.back(), { kind: "quiet" }),
    );
  }

  private named(): HTMLElement {
    const name = h("input", { type: "text", class: "text-field", placeholder: t("selectionName"), "aria-label": t("selectionName"), maxLength: 60 });
    const keep = (): void => {
      if (!name.value.trim()) return;
      this.actions.keep(name.value.trim());
      name.value = "";
      name.blur();
    };
    name.addEventListener("keydown", (event) => {
      if (event.key === "Enter") keep();
    });
    const entries = this.studio.scene?.selections ?? [];
    return h(
      "div",
      { class: "named-selections" },
      ...entries.map(({ name: known, count }) =>
        h(
          "div",
          { class: "named-selection", "data-selection": known },
          h("span", { class: "named-name", title: known }, known),
          h("span", { class: "muted" }, grouped(count)),
          iconButton("region", `${t("recallRegion")}: ${known}`, () => this.actions.recall(known, "region")),
          iconButton("target", `${t("recallHandle")}: ${known}`, () => this.actions.recall(known, "handle")),
          iconButton("trash", `${t("remove")}: ${known}`, () => this.actions.forget(known)),
        ),
      ),
      h("div", { class: "keep-row" }, name, button(t("keep"), keep)),
    );
  }

  private skeletonRows(): HTMLElement {
    const { choice } = this.skeleton;
    const places = [["off", t("skeletonOff")], ["over", t("skeletonOver")], ["beside", t("skeletonBeside")]] as const;
    const change = (part: Partial<SkeletonChoice>): void => this.actions.skeleton(part);
    return h(
      "div",
      null,
      row(t("show"), segments<Where>(places, choice.where, (where) => change({ where }))),
      choice.where !== "off" && checkbox(t("showMesh"), this.studio.mesh.object.visible, (on) => this.actions.mesh(on)),
      choice.where !== "off" &&
        row(t("contours"), numberField(choice.contours, (contours) => change({ contours }), { label: t("contours"), integer: true, low: 1 })),
      choice.where !== "off" &&
        row(
          t("eigenvectors"),
          numberField(choice.eigenvectors, (eigenvectors) => change({ eigenvectors }), { label: t("eigenvectors"), integer: true, low: 2 }),
        ),
    );
  }
}

const grouped = (count: number): string => count.toLocaleString("en").replaceAll(",", " ");
