// The first steps in this mode.

import type { TourStep } from "../../panels/tour";

export const cageTour = (): TourStep[] => [
  { at: "[data-section=mode-cage]", title: "cageTourBuild", text: "cageTourBuildText" },
  { title: "cageTourPlanes", text: "cageTourPlanesText" },
  { title: "cageTourDrag", text: "cageTourDragText" },
];
