// The sheet of keys and mouse gestures, and the guides of the modes.

import { h } from "../core/dom";
import { icon } from "../core/icons";
import { t } from "../core/strings";
import type { KeyLine } from "../modes/key_lists";
import type { Mode } from "../modes/mode";
import type { Studio } from "../studio";
import { button } from "./controls";
import { openDialog } from "./dialog";
import type { Tours } from "./tour";

const everywhere = (modes: Mode[]): KeyLine[] => [
  ["Drag", "key_orbit"],
  ["Right-drag", "key_pan"],
  ["Wheel", "key_zoom"],
  ["F", "key_frame"],
  ["P", "key_ortho"],
  ["W", "key_wireframe"],
  ["C", "key_compare"],
  [modes.map((mode) => mode.shortcut.toUpperCase()).join("  "), "key_modes"],
  ["Ctrl-Z  Ctrl-Y", "key_undo"],
  ["Ctrl-S", "key_save"],
  ["Ctrl-O  Ctrl-E", "key_files"],
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
  const now = studio.mode.value;
  const own = tours.modes.filter((mode) => mode.shortcuts);
  const sheets = own.map((mode) =>
    h(
      "details",
      { class: "mode-keys", open: mode === now },
      h("summary", null, icon(mode.icon) as unknown as Node, t(mode.title), h("kbd", null, mode.shortcut.toUpperCase())),
      sheet(mode.shortcuts!),
    ),
  );
  const list = h("div", null, sheet(everywhere(tours.modes)), ...sheets);
  const dialog = openDialog(studio.root, t("shortcuts"), h("div", null, studio.scene?.mesh ? guides : null, list));
}

const sheet = (lines: readonly KeyLine[]): HTMLElement =>
  h(
    "dl",
    { class: "keys" },
    ...lines.flatMap(([keys, text]) => [
      h("dt", null, ...keys.split("  ").map((key) => h("kbd", null, key))),
      h("dd", null, t(text)),
    ]),
  );
