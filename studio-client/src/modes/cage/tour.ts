// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const cageTour = (): TourStep[] => [
  { at: "[data-section=mode-cage]", title: "cageTourBuild", text: "cageTourBuildText" },
  { at: "[data-section=mode-cage] .segments", title: "cageTourPlanes", text: "cageTourPlanesText" },
  { at: ".stage-top .toolbar", title: "cageTourDrag", text: "cageTourDragText" },
];
