// Look: every drag turns the view.

import { registerMode } from "./mode";

registerMode(() => ({
  id: "look",
  icon: "view",
  title: "modeView",
  hint: "hintView",
  shortcut: "1",
  enter: () => undefined,
  leave: () => undefined,
  tour: () => [
    { title: "tourLookTurn", text: "tourLookTurnText" },
    { at: ".axis-gizmo", title: "tourLookAxes", text: "tourLookAxesText" },
    { at: ".view-tools", title: "tourLookCompare", text: "tourLookCompareText" },
  ],
}));
