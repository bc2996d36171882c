// The bar at the top: the document, undo and redo, the view, export, theme, language, help.

import { h, replace } from "../core/dom";
import { icon } from "../core/icons";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import type { Actions } from "./actions";
import { button, iconButton } from "./controls";
import { openMenu } from "./deformer_menu";

export function topBar(studio: Studio, actions: Actions): HTMLElement {
  const element = h("header", { class: "topbar" });
  const show = (): void => {
    const { scene } = studio;
    const loaded = scene !== null && scene.mesh !== null;
    const undo = iconButton("undo", `${t("undo")} (Ctrl-Z)`, () => actions.undo());
    const redo = iconButton("redo", `${t("redo")} (Ctrl-Y)`, () => actions.redo());
    undo.disabled = !scene || scene.history.position === 0;
    redo.disabled = !scene || scene.history.position >= scene.history.labels.length - 1;
    replace(
      element,
      h("button", { class: "brand", type: "button", title: t("home"), onclick: () => actions.home() }, icon("logo", 20) as unknown as Node, h("span", null, "pliant")),
      button(t("open"), () => actions.openMenu(element.querySelector<HTMLElement>("[data-open]")!), { icon: "open", kind: "quiet" }),
      loaded && h("div", { class: "document" }, h("span", { class: "document-name" }, scene.name), scene.dirty && h("span", { class: "document-state" }, t("unsaved"))),
      h("span", { class: "spacer" }),
      loaded && undo,
      loaded && redo,
      loaded && h("span", { class: "separator" }),
      loaded && iconButton("save", `${t("saveProject")} (Ctrl-S)`, () => actions.save()),
      loaded && button(t("export"), () => actions.export(), { icon: "export", kind: "primary" }),
      h("span", { class: "separator" }),
      iconButton(studio.settings.dark ? "sun" : "moon", t("theme"), () => studio.settings.change({ theme: studio.settings.dark ? "light" : "dark" })),
      iconButton("language", t("language"), (event) =>
        openMenu(studio.root, event.currentTarget as HTMLElement, [
          { label: "English", checked: studio.settings.now.language === "en", run: () => studio.settings.change({ language: "en" }) },
          { label: "中文", checked: studio.settings.now.language === "zh-CN", run: () => studio.settings.change({ language: "zh-CN" }) },
        ]),
      ),
      iconButton("help", `${t("help")} (?)`, () => actions.help()),
    );
    element.children[1]?.setAttribute("data-open", "");
  };
  studio.session.scene.watch(show);
  studio.settings.all.onChange(show);
  return element;
}
