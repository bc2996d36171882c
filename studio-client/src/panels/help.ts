// The sheet of keys and mouse gestures, and the guides of the modes.

import { h } from "../core/dom";
import { t, type StringKey } from "../core/strings";
import type { Mode } from "../modes/mode";
import type { Studio } from "../studio";
import { button } from "./controls";
import { openDialog } from "./dialog";
import type { Tours } from "./tour";

const keysOf = (modes: Mode[]): [string, StringKey][] => [
  ["Drag", "key_orbit"],
  ["Right-drag", "key_pan"],
  ["Wheel", "key_zoom"],
  ["F", "key_frame"],
  ["P", "key_ortho"],
  ["C", "key_compare"],
  [modes.map((mode) => mode.shortcut).join("  "), "key_modes"],
  ["G  R  S", "key_tools"],
  ["X  Y  Z", "key_axis"],
  ["B  /  Shift-drag", "key_rectangle"],
  ["Shift-click", "key_grow"],
  ["Alt-click", "key_layer"],
  ["A", "key_all"],
  ["Delete", "key_reset"],
  ["Esc", "key_escape"],
  ["Ctrl-Z  Ctrl-Y", "key_undo"],
  ["Ctrl-S", "key_save"],
  ["?", "key_help"],
];

export function openHelp(studio: Studio, tours: Tours): void {
  const guides = h(
    "div",
    { class: "guides", role: "group", "aria-label": t("guides") },
    h("span", null, t("guidesText")),
    ...tours.guided.map((mode) => {
      const start = (): void => {
        dialog.close();
        tours.start(mode);
      };
      return button(t(mode.title), start, { icon: mode.icon });
    }),
  );
  const list = h(
    "dl",
    { class: "keys" },
    ...keysOf(tours.modes).flatMap(([keys, text]) => [
      h("dt", null, ...keys.split("  ").map((key) => h("kbd", null, key))),
      h("dd", null, t(text)),
    ]),
  );
  const dialog = openDialog(studio.root, t("shortcuts"), h("div", null, studio.scene?.mesh ? guides : null, list));
}
