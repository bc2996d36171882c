// The start page: what the studio is for, a place to drop files, examples, recent files, unsaved work.

import { h, replace } from "../core/dom";
import { icon } from "../core/icons";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import { button } from "./controls";
import type { Opening } from "./opening";
import { thumbnail } from "./thumbnails";

export function startPage(studio: Studio, opening: Opening): HTMLElement {
  const element = h("main", { class: "start", hidden: true });
  const show = (): void => {
    const catalogue = studio.session.catalogue.value;
    element.hidden = studio.scene === null || studio.scene.mesh !== null;
    if (element.hidden || !catalogue) return;
    replace(
      element,
      h(
        "div",
        { class: "start-body" },
        h("h1", null, t("startTitle")),
        h("p", { class: "lead" }, t("startText")),
        dropZone(opening),
        catalogue.recoverable.length > 0 && recovery(studio, opening),
        h("h2", null, t("examples")),
        h("div", { class: "cards" }, ...catalogue.examples.map((example) => card(opening, example))),
        h("h2", null, t("recent")),
        recent(catalogue.recent, opening),
      ),
    );
  };
  studio.session.catalogue.onChange(show);
  studio.session.scene.watch(show);
  studio.settings.all.onChange(show);
  return element;
}

function dropZone(opening: Opening): HTMLElement {
  return h(
    "button",
    { class: "drop-zone", type: "button", onclick: () => opening.choose() },
    icon("import", 30) as unknown as Node,
    h("strong", null, t("dropHere")),
    h("span", { class: "muted" }, t("dropDetail")),
    h("span", { class: "button primary" }, t("chooseFile")),
  );
}

function card(opening: Opening, example: { name: string; title: string; points: number }): HTMLElement {
  return h(
    "button",
    { class: "card", type: "button", "data-example": example.name, onclick: () => void opening.open("open.example", { name: example.name }) },
    thumbnail(example.name),
    h("strong", null, example.title),
    h("span", { class: "muted" }, `${example.points.toLocaleString("en").replaceAll(",", " ")} ${t("vertices")}`),
  );
}

function recovery(studio: Studio, opening: Opening): HTMLElement {
  const entries = studio.session.catalogue.value?.recoverable ?? [];
  return h(
    "div",
    { class: "recovery" },
    h("div", null, h("strong", null, t("recover")), h("p", { class: "muted" }, t("recoverText"))),
    ...entries.map(({ name, when }) =>
      button(when, () => void opening.open("open.recover", { name }), { icon: "history", kind: "primary" }),
    ),
  );
}

function recent(names: string[], opening: Opening): HTMLElement {
  if (!names.length) return h("p", { class: "muted" }, t("noRecent"));
  return h(
    "div",
    { class: "recent" },
    ...names.map((name) =>
      h(
        "button",
        { type: "button", class: "file-entry", onclick: () => void opening.open("open.path", { path: name }) },
        icon("file") as unknown as Node,
        h("span", null, name),
      ),
    ),
  );
}
