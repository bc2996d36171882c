// The bar of the mode: one button a deformer, and snapping.

import { h } from "../../core/dom";
import type { IconName } from "../../core/icons";
import { t, tWord } from "../../core/strings";
import { iconButton, toggle } from "../../panels/controls";
import type { Studio } from "../../studio";
import { separator } from "../points_tools";

const KINDS: readonly (readonly [string, IconName])[] = [
  ["twist", "twist"],
  ["bend", "bend"],
  ["taper", "taper"],
  ["flare", "flare"],
  ["squash", "squash"],
  ["sine", "sine"],
  ["wave", "wave"],
  ["scale", "scale"],
];

export function axialToolbar(studio: Studio, snap: boolean, onSnap: (on: boolean) => void): HTMLElement {
  const add = async (kind: string): Promise<void> => {
    const answer = await studio.ask("layers.add", { kind, fields: kind === "sine" ? { normal: "x" } : {} });
    if (answer) studio.activeLayer.set(answer.head["layer"] as string);
  };
  const magnet = toggle("magnet", `${t("snap")} (N)`, snap, onSnap);
  magnet.classList.add("axial-snap");
  return h(
    "div",
    { class: "toolbar", role: "toolbar" },
    h("span", { class: "toolbar-label" }, t("add")),
    ...KINDS.map(([kind, icon]) => iconButton(icon, tWord("kind_", kind), () => void add(kind))),
    separator(),
    magnet,
  );
}
