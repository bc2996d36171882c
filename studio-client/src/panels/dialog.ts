// Dialogs: the browser's own, which keep the focus inside and close with Escape.

import { h } from "../core/dom";
import { t } from "../core/strings";
import { button, iconButton } from "./controls";

export interface Dialog {
  element: HTMLDialogElement;
  close: () => void;
}

/** Show a dialog. Where it has an action, that closes it unless it gives false. */
export function openDialog(
  root: HTMLElement,
  title: string,
  body: HTMLElement,
  action?: { label: string; run: () => Promise<boolean> | boolean },
): Dialog {
  const close = (): void => element.close();
  const run = async (): Promise<void> => {
    if (!action) return;
    element.classList.add("busy");
    const done = await action.run();
    element.classList.remove("busy");
    if (done) close();
  };
  const foot = action
    ? h(
        "div",
        { class: "dialog-foot" },
        button(t("cancel"), close, { kind: "quiet" }),
        button(action.label, () => void run(), { kind: "primary" }),
      )
    : null;
  const element: HTMLDialogElement = h(
    "dialog",
    { class: "dialog", "aria-label": title },
    h("div", { class: "dialog-head" }, h("h2", null, title), iconButton("close", t("close"), close)),
    h("div", { class: "dialog-body" }, body),
    foot,
  );
  element.addEventListener("close", () => element.remove());
  element.addEventListener("click", (event) => {
    if (event.target === element) close();
  });
  element.addEventListener("keydown", (event) => {
    event.stopPropagation();
    const target = event.target as HTMLElement;
    if (event.key === "Enter" && action && target.tagName !== "BUTTON") void run();
  });
  root.append(element);
  element.showModal();
  return { element, close };
}
