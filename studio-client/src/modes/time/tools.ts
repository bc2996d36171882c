// The bar above the canvas: placing the tool, the object through it, and ghosts of other moments.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, iconButton, numberField, press, select, toggle } from "../../panels/controls";
import type { Tool } from "../../view/gizmo";
import { separator } from "../point_toolbar";
import type { ClipModel } from "./clip_model";
import type { Ghosts } from "./ghosts";
import type { Placer } from "./placer";

const TOOLS = [["translate", "move", "toolMove", "G"], ["rotate", "rotate", "toolRotate", "R"], ["scale", "scale", "toolScale", "S"]] as const;

export class TimeTools {
  private readonly element = h("div", { class: "toolbar", role: "toolbar" });

  constructor(
    private readonly model: ClipModel,
    private readonly placer: Placer,
    private readonly ghosts: Ghosts,
  ) {
    ghosts.choice.onChange(() => this.show());
  }

  bar(): HTMLElement {
    this.show();
    return this.element;
  }

  setTool(tool: Tool): void {
    this.placer.setTool(tool);
    if (!this.placer.on) this.placer.start();
    this.show();
  }

  private show(): void {
    const { placer, ghosts, model } = this;
    const { on, count, every } = ghosts.choice.value;
    const spacing = [["1", "1"], ["2", "2"], ["4", "4"], ["8", "8"], ["0", t("timeAtKeys")]] as const;
    replace(
      this.element,
      toggle("target", t("timePlace"), placer.on, (now) => {
        if (now) placer.start();
        else placer.stop();
        this.show();
      }),
      ...(placer.on ? TOOLS.map(([tool, icon, title, key]) => this.tool(tool, icon, `${t(title)} (${key})`)) : []),
      placer.on && button(t("timeThrough"), () => void this.through(), { kind: "quiet", icon: "pull" }),
      separator(),
      toggle("onion", t("timeOnion"), on, (now) => ghosts.change({ on: now })),
      on && numberField(count, (value) => ghosts.change({ count: Math.min(Math.max(value, 1), 6) }), { label: t("timeGhosts"), integer: true, low: 1 }),
      on && h("span", { class: "toolbar-label" }, t("timeEvery")),
      on && select(spacing, String(every) as "4", (value) => ghosts.change({ every: Number(value) }), t("timeEvery")),
      on && every > 0 && h("span", { class: "toolbar-label" }, t("timeFrames")),
    );
    model.studio.viewport.request();
  }

  private tool(tool: Tool, name: "move" | "rotate" | "scale", label: string): HTMLElement {
    const each = iconButton(name, label, () => this.setTool(tool));
    press(each, this.placer.tool === tool);
    return each;
  }

  /** Below the active layer, one that moves the object. */
  private async through(): Promise<void> {
    const { studio } = this.model;
    const answer = await studio.ask("place.through", { layer: studio.activeLayer.value });
    if (answer) studio.activeLayer.set(answer.head["layer"] as string);
  }
}
