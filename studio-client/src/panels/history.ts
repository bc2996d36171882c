// The history: every change, the last on top; a click goes back to it, or forward again.

import { h, replace } from "../core/dom";
import { tWord } from "../core/strings";
import type { Studio } from "../studio";

export function historyPanel(studio: Studio): HTMLElement {
  const body = h("ol", { class: "history", reversed: true });
  studio.session.scene.watch((scene) => {
    const { labels, position } = scene?.history ?? { labels: [], position: 0 };
    const rows = labels.map((label, at) =>
      h(
        "li",
        { class: at > position ? "undone" : at === position ? "now" : "" },
        h(
          "button",
          {
            type: "button",
            "aria-current": at === position ? "step" : undefined,
            onclick: () => void studio.ask("history.goto", { position: at }),
          },
          `${tWord("did_", label.key)} ${label.subject}`,
        ),
      ),
    );
    replace(body, ...rows.reverse());
  });
  return body;
}
