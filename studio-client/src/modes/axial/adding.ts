// The bar of the mode: one button a deformer, and snapping.

import { h } from "../../core/dom";
import type { IconName } from "../../core/icons";
import { t, tWord } from "../../core/strings";
import { iconButton, toggle } from "../../panels/controls";
import type { Studio } from "../../studio";
import { separator } from "../point_toolbar";

const KINDS: readonly (readonly [string, IconName])[] = [
  ["twist", "twist"],
  ["bend", "bend"],
  ["taper", "taper"],
  ["flare", "flare"],
  ["squash", "squash"],
  ["sine", "sine"],
  ["wave", "wave"],
  ["scale", "scale"],
  ["tangent-frames", "tendril"],
];

/** Lay a deformer around the shape, along the axis that points up; its layer, if there is one. */
export async function addAxial(studio: Studio, kind: string): Promise<string | null> {
  const answer = await studio.ask("layers.add", { kind, fields: upright(kind, studio.settings.now.up) });
  if (!answer) return null;
  const layer = answer.head["layer"] as string;
  studio.activeLayer.set(layer);
  return layer;
}

function upright(kind: string, up: "y" | "z"): Record<string, string> {
  if (kind === "scale") return {};
  if (kind === "bend") return { axis: "x", normal: up === "z" ? "y" : "z" }; // about an axis across, in the upright plane
  return kind === "sine" ? { axis: up, normal: "x" } : { axis: up };
}

export function axialToolbar(snap: boolean, onSnap: (on: boolean) => void, add: (kind: string) => void): HTMLElement {
  const magnet = toggle("magnet", `${t("snap")} (N)`, snap, onSnap);
  magnet.classList.add("axial-snap");
  return h(
    "div",
    { class: "toolbar", role: "toolbar" },
    h("span", { class: "toolbar-label" }, t("add")),
    ...KINDS.map(([kind, icon]) => iconButton(icon, tWord("kind_", kind), () => add(kind))),
    separator(),
    magnet,
  );
}
