// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const sitesTour = (): TourStep[] => [
  { title: "sitesTourPlace", text: "sitesTourPlaceText" },
  { title: "sitesTourDrag", text: "sitesTourDragText" },
  { at: "[data-section=mode-sites]", title: "sitesTourPanel", text: "sitesTourPanelText" },
];
