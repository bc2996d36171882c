// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const axialTour = (): TourStep[] => [
  { at: ".stage-top .toolbar", title: "axialTourAdd", text: "axialTourAddText" },
  { title: "axialTourDrag", text: "axialTourDragText" },
  { at: "[data-section=layers]", title: "axialTourStack", text: "axialTourStackText" },
];
