// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const faceTour = (): TourStep[] => [
  { at: ".section[data-section=mode-face]", title: "faceTourPhoto", text: "faceTourPhotoText" },
  { at: ".caricature, .section[data-section=mode-face]", title: "faceTourSliders", text: "faceTourSlidersText" },
];
