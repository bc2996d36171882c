// The buttons beside the canvas: how the shape is drawn, and comparisons with the original.

import { h } from "../core/dom";
import { t } from "../core/strings";
import type { Settings } from "../core/settings";
import type { Studio } from "../studio";
import type { Actions } from "./actions";
import { iconButton, press, toggle } from "./controls";
import { openMenu } from "./deformer_menu";

export function viewTools(studio: Studio, actions: Actions, compare: Compare): HTMLElement {
  const { settings } = studio;
  const flip = (name: "wireframe" | "texture" | "ground" | "orthographic"): void => {
    settings.change({ [name]: !settings.now[name] } as Partial<Settings>);
  };
  const hold = iconButton("history", `${t("compareHold")} (C)`, () => undefined);
  hold.addEventListener("pointerdown", () => compare.hold(true));
  for (const end of ["pointerup", "pointerleave", "blur"]) hold.addEventListener(end, () => compare.hold(false));
  const slide = toggle("compare", t("compareSlider"), false, (on) => compare.slide(on));
  compare.onSlide = (on) => press(slide, on);
  return h(
    "div",
    { class: "view-tools", role: "toolbar", "aria-orientation": "vertical" },
    iconButton("frame", `${t("frameAll")} (F)`, () => actions.frame()),
    toggle("wire", `${t("wireframe")} (W)`, settings.now.wireframe, () => flip("wireframe")),
    iconButton("shade", t("view"), (event) =>
      openMenu(studio.root, event.currentTarget as HTMLElement, [
        { label: t("texture"), checked: settings.now.texture, run: () => flip("texture") },
        { label: t("flat"), checked: settings.now.shading === "flat", run: () => settings.change({ shading: settings.now.shading === "flat" ? "smooth" : "flat" }) },
        { label: t("wireframe"), checked: settings.now.wireframe, run: () => flip("wireframe") },
        { label: t("ground"), checked: settings.now.ground, run: () => flip("ground") },
        { label: t("orthographic"), keys: "P", checked: settings.now.orthographic, run: () => flip("orthographic") },
        null,
        { label: `${t("upAxis")}: z`, checked: settings.now.up === "z", run: () => settings.change({ up: "z" }) },
        { label: `${t("upAxis")}: y`, checked: settings.now.up === "y", run: () => settings.change({ up: "y" }) },
      ]),
    ),
    hold,
    slide,
  );
}

/** Before and after: all of the old shape while a key is held, or a divide that can be dragged. */
export class Compare {
  readonly divider = h("div", { class: "divider", hidden: true, role: "slider", tabindex: "0", "aria-label": t("compareSlider") });
  onSlide: (on: boolean) => void = () => undefined;
  private at = 0.5;

  constructor(private readonly studio: Studio) {
    const { viewport, mesh } = studio;
    viewport.beforeDraw = (side) => mesh.showSide(side);
    this.divider.append(h("span", { class: "divider-label left" }, t("before")), h("span", { class: "divider-label right" }, t("after")));
    this.divider.addEventListener("pointerdown", (event) => this.divider.setPointerCapture(event.pointerId));
    this.divider.addEventListener("pointermove", (event) => {
      if (event.buttons) this.place((event.clientX - viewport.element.getBoundingClientRect().left) / viewport.size.width);
    });
    this.divider.addEventListener("keydown", (event) => {
      if (event.key === "ArrowLeft") this.place(this.at - 0.02);
      if (event.key === "ArrowRight") this.place(this.at + 0.02);
    });
    viewport.element.append(this.divider);
  }

  async hold(on: boolean): Promise<void> {
    if (on && !(await this.ready())) return;
    this.studio.viewport.divide = on ? 1 : this.divider.hidden ? null : this.at;
    this.studio.viewport.helpers.visible = !on;
    this.studio.viewport.request();
  }

  async slide(on: boolean): Promise<void> {
    if (on && !(await this.ready())) {
      this.onSlide(false);
      return;
    }
    this.divider.hidden = !on;
    this.studio.viewport.divide = on ? this.at : null;
    this.place(this.at);
    this.onSlide(on);
  }

  private place(at: number): void {
    this.at = Math.min(Math.max(at, 0.02), 0.98);
    this.divider.style.left = `${100 * this.at}%`;
    this.divider.setAttribute("aria-valuenow", String(Math.round(100 * this.at)));
    if (!this.divider.hidden) this.studio.viewport.divide = this.at;
    this.studio.viewport.request();
  }

  private async ready(): Promise<boolean> {
    if (this.studio.mesh.hasRest) return true;
    const answer = await this.studio.ask("mesh.rest");
    if (!answer) return false;
    this.studio.mesh.setRest(answer.arrays["positions"] as Float32Array, answer.arrays["normals"] as Int8Array);
    return true;
  }
}
