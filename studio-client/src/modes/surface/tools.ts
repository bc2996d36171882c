// The tools of surface editing: four that pick, three that move the handle; what is picked, and how deep.

import { h, replace } from "../../core/dom";
import type { IconName } from "../../core/icons";
import { Signal } from "../../core/signal";
import { t, type StringKey } from "../../core/strings";
import { iconButton, press, segments, toggle } from "../../panels/controls";
import type { Tool } from "../../view/gizmo";
import { separator } from "../point_toolbar";
import type { Part } from "./region";

export type Picker = "rectangle" | "lasso" | "brush" | "geodesic";
export type Method = "laplacian" | "arap" | "skeleton";

export interface SurfaceTools {
  tool: Picker | Tool;
  part: Part;
  visible: boolean;
  /** Radius of the brush, in pixels. */
  brush: number;
  method: Method;
}

export const METHODS: readonly [Method, StringKey][] = [
  ["laplacian", "methodLaplacian"],
  ["arap", "methodARAP"],
  ["skeleton", "methodSkeleton"],
];

const PICKERS: [Picker, IconName, StringKey, string][] = [
  ["rectangle", "rectangle", "toolRectangle", "B"],
  ["lasso", "lasso", "toolLasso", "L"],
  ["brush", "brush", "toolBrush", "D"],
  ["geodesic", "ripple", "toolGeodesic", "E"],
];

const MOVERS: [Tool, IconName, StringKey, string][] = [
  ["translate", "move", "toolMove", "G"],
  ["rotate", "rotate", "toolRotate", "R"],
  ["scale", "scale", "toolScale", "S"],
];

export class SurfaceToolbar {
  readonly state = new Signal<SurfaceTools>({
    tool: "rectangle",
    part: "region",
    visible: true,
    brush: 26,
    method: "laplacian",
  });

  get now(): SurfaceTools {
    return this.state.value;
  }

  change(part: Partial<SurfaceTools>): void {
    this.state.set({ ...this.now, ...part });
  }

  /** The tool that picks; null where the handle is moved. */
  get picker(): Picker | null {
    return PICKERS.find(([name]) => name === this.now.tool)?.[0] ?? null;
  }

  get mover(): Tool | null {
    return MOVERS.find(([name]) => name === this.now.tool)?.[0] ?? null;
  }

  /** True where a key chooses a tool. */
  key(key: string): boolean {
    const found = [...PICKERS, ...MOVERS].find(([, , , letter]) => letter.toLowerCase() === key);
    if (found) this.change({ tool: found[0] });
    else if (key === "h") this.change({ part: this.now.part === "region" ? "handle" : "region" });
    else if (key === "v") this.change({ visible: !this.now.visible });
    else if (key === "[" || key === "]") this.change({ brush: clamp(this.now.brush * (key === "[" ? 0.8 : 1.25), 4, 200) });
    else return false;
    return true;
  }

  bar(): HTMLElement {
    const element = h("div", { class: "toolbar", role: "toolbar" });
    this.state.watch(() => this.fill(element));
    return element;
  }

  private fill(element: HTMLElement): void {
    const { now } = this;
    const tool = ([name, symbol, label, letter]: [SurfaceTools["tool"], IconName, StringKey, string]): HTMLElement => {
      const each = iconButton(symbol, `${t(label)} (${letter})`, () => this.change({ tool: name }));
      press(each, now.tool === name);
      return each;
    };
    const parts = segments<Part>([["region", t("region")], ["handle", t("handlePart")]], now.part, (part) => this.change({ part }));
    parts.title = `${t("pickInto")} (H)`;
    parts.classList.add("part-choice");
    replace(
      element,
      ...MOVERS.map(tool),
      separator(),
      ...PICKERS.map(tool),
      separator(),
      parts,
      toggle("through", `${t("pickThrough")} (V)`, !now.visible, (through) => this.change({ visible: !through })),
    );
  }
}

const clamp = (value: number, low: number, high: number): number => Math.min(Math.max(value, low), high);
