// The menu of deformers, made from the server's catalogue: one that is new in the library stands in it.

import { h, replace } from "../core/dom";
import { icon } from "../core/icons";
import { t, term, type StringKey } from "../core/strings";
import { KINDS } from "../core/strings/terms";
import type { Studio } from "../studio";
import type { Kind } from "../transport/protocol";
import { newExtended } from "./extended_dialog";
import { newLattice } from "./lattice_dialog";

const GROUPS: Record<string, StringKey> = { lattice: "groupLattices", shape: "groupShapes", field: "groupFields" };
const EXTENDED = "extended-ffd";
const LATTICES = ["bspline-ffd", "bezier-ffd"];

export function chooseDeformer(studio: Studio, anchor: HTMLElement): void {
  const list = h("div", { class: "menu-list" });
  const search = h("input", { class: "search", type: "search", placeholder: t("searchDeformers"), "aria-label": t("searchDeformers") });
  const menu = h("div", { class: "popover deformer-menu", role: "menu", popover: "auto" }, search, list);
  const close = (): void => menu.hidePopover();
  const fill = (): void => {
    const word = search.value.trim().toLowerCase();
    const kinds = studio.session.catalogue.value?.kinds ?? [];
    const matching = word ? found(kinds, word) : [];
    if (matching.length) replace(list, ...matching.map((kind) => item(studio, kind, close)));
    else if (word) replace(list, h("p", { class: "muted menu-title" }, t("noDeformer")));
    else replace(list, ...Object.entries(GROUPS).flatMap(([group, title]) => inGroup(studio, kinds, group, t(title), close)));
  };
  search.addEventListener("input", fill);
  search.addEventListener("keydown", (event) => {
    if (event.key === "Enter") {
      event.preventDefault(); // else it would press a button of the dialog that opens
      list.querySelector<HTMLElement>("button")?.click();
    }
    event.stopPropagation();
  });
  fill();
  showPopover(studio.root, menu, anchor);
  search.focus();
}

/** Those whose name begins with a word, then those whose name holds it, then those whose description does. */
function found(kinds: Kind[], word: string): Kind[] {
  const rank = ({ name, title, summary }: Kind): number => {
    const at = Math.max(title.toLowerCase().indexOf(word), term(KINDS, name, title).toLowerCase().indexOf(word));
    return at === 0 ? 0 : at > 0 ? 1 : `${summary} ${shapes(name)}`.toLowerCase().includes(word) ? 2 : 3;
  };
  return kinds.filter((kind) => rank(kind) < 3).sort((a, b) => rank(a) - rank(b));
}

/** What a deformer's dialog offers to choose from. */
const shapes = (kind: string): string => (kind === EXTENDED ? [t("cylinder"), t("prism"), t("sphere")].join(", ") : "");

function inGroup(studio: Studio, kinds: Kind[], group: string, title: string, close: () => void): HTMLElement[] {
  const own = kinds.filter((kind) => kind.group === group);
  if (!own.length) return [];
  return [h("div", { class: "menu-title" }, title), ...own.map((kind) => item(studio, kind, close))];
}

function item(studio: Studio, kind: Kind, close: () => void): HTMLElement {
  const choose = (): void => {
    close();
    if (kind.name === EXTENDED) newExtended(studio);
    else if (LATTICES.includes(kind.name)) newLattice(studio, kind.name === "bspline-ffd" ? "bspline" : "bezier");
    else void studio.ask("layers.add", { kind: kind.name }).then((answer) => {
      if (answer) studio.activeLayer.set(answer.head["layer"] as string);
    });
  };
  return h(
    "button",
    { class: "menu-item", type: "button", role: "menuitem", onclick: choose, "data-kind": kind.name },
    h("span", { class: "menu-item-title" }, term(KINDS, kind.name, kind.title)),
    h("span", { class: "muted" }, [shapes(kind.name), kind.summary].filter((each) => each).join(". ")),
  );
}

/** A popover beside what opened it, within the window. */
export function showPopover(root: HTMLElement, menu: HTMLElement, anchor: HTMLElement): void {
  root.append(menu);
  menu.addEventListener("toggle", (event) => {
    if (event.newState === "closed") menu.remove();
  });
  menu.showPopover();
  const at = anchor.getBoundingClientRect();
  const { offsetWidth: wide, offsetHeight: high } = menu;
  menu.style.left = `${Math.max(8, Math.min(at.right - wide, innerWidth - wide - 8))}px`;
  menu.style.top = `${Math.max(8, Math.min(at.bottom + 6, innerHeight - high - 8))}px`;
}

export interface MenuEntry {
  label: string;
  icon?: Parameters<typeof icon>[0];
  keys?: string;
  checked?: boolean;
  run: () => void;
}

/** A plain menu of commands. */
export function openMenu(root: HTMLElement, anchor: HTMLElement, entries: (MenuEntry | null)[]): void {
  const menu = h("div", { class: "popover", role: "menu", popover: "auto" });
  for (const entry of entries) {
    if (!entry) menu.append(h("hr"));
    else {
      const run = (): void => {
        menu.hidePopover();
        entry.run();
      };
      menu.append(
        h(
          "button",
          {
            class: "menu-item plain",
            type: "button",
            role: entry.checked === undefined ? "menuitem" : "menuitemcheckbox",
            "aria-checked": entry.checked === undefined ? undefined : String(entry.checked),
            onclick: run,
          },
          h("span", { class: "menu-icon" }, entry.checked ? (icon("check", 15) as unknown as Node) : entry.icon ? (icon(entry.icon, 16) as unknown as Node) : ""),
          h("span", null, entry.label),
          entry.keys ? h("kbd", null, entry.keys) : null,
        ),
      );
    }
  }
  showPopover(root, menu, anchor);
  menu.querySelector("button")?.focus();
}
