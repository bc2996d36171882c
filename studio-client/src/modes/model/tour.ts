// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const modelTour = (): TourStep[] => [
  { at: ".section[data-section=mode-model]", title: "modelTourBegin", text: "modelTourBeginText" },
  { title: "modelTourLandmarks", text: "modelTourLandmarksText" },
  { at: ".section[data-section=mode-model]", title: "modelTourFit", text: "modelTourFitText" },
];
