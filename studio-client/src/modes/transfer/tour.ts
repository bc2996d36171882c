// The guide to deformation transfer.

import type { TourStep } from "../../panels/tour";

export const transferTour = (): TourStep[] => [
  { at: "[data-section=mode-transfer]", title: "transferTour1", text: "transferTour1Text" },
  { title: "transferTour2", text: "transferTour2Text" },
  { at: "[data-section=mode-transfer]", title: "transferTour3", text: "transferTour3Text" },
];
