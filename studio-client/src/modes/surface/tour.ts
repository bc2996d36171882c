// The guide to surface editing.

import type { TourStep } from "../../panels/tour";

export const surfaceTour = (): TourStep[] => [
  { at: ".stage .toolbar", title: "surfaceTour1", text: "surfaceTour1Text" },
  { at: ".part-choice", title: "surfaceTour2", text: "surfaceTour2Text" },
  { title: "surfaceTour3", text: "surfaceTour3Text" },
  { at: "[data-section=mode-surface]", title: "surfaceTour4", text: "surfaceTour4Text" },
];
