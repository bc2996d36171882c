// The sheet of keys and mouse gestures.

import { h } from "../core/dom";
import { t, type StringKey } from "../core/strings";
import type { Studio } from "../studio";
import { openDialog } from "./dialog";

const KEYS: [string, StringKey][] = [
  ["Drag", "key_orbit"],
  ["Right-drag", "key_pan"],
  ["Wheel", "key_zoom"],
  ["F", "key_frame"],
  ["P", "key_ortho"],
  ["C", "key_compare"],
  ["1  2  3", "key_modes"],
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

export function openHelp(studio: Studio): void {
  const list = h(
    "dl",
    { class: "keys" },
    ...KEYS.flatMap(([keys, text]) => [
      h("dt", null, ...keys.split("  ").map((key) => h("kbd", null, key))),
      h("dd", null, t(text)),
    ]),
  );
  openDialog(studio.root, t("shortcuts"), list);
}
