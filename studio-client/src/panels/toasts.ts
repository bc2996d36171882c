// Short notes in the corner: what went wrong, in the library's words, or what was done.

import { h } from "../core/dom";
import { icon } from "../core/icons";
import { t } from "../core/strings";
import { iconButton } from "./controls";

const STAY = 4500;

export class Toasts {
  readonly element = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

  info(text: string, detail: string[] = []): void {
    this.show("info", text, detail, STAY + 900 * detail.length);
  }

  error(text: string): void {
    this.show("error", text, [], Math.max(STAY, 60 * text.length));
  }

  private show(kind: "info" | "error", text: string, detail: string[], stay: number): void {
    const toast = h(
      "div",
      { class: `toast ${kind}`, role: kind === "error" ? "alert" : "status" },
      icon(kind === "error" ? "warning" : "check", 18) as unknown as Node,
      h("div", { class: "toast-text" }, h("p", null, text), ...detail.map((line) => h("p", { class: "muted" }, line))),
      iconButton("close", t("close"), () => toast.remove()),
    );
    this.element.append(toast);
    while (this.element.children.length > 4) this.element.firstElementChild!.remove();
    let left = window.setTimeout(() => toast.remove(), stay);
    toast.addEventListener("mouseenter", () => clearTimeout(left));
    toast.addEventListener("mouseleave", () => {
      left = window.setTimeout(() => toast.remove(), STAY);
    });
  }
}
