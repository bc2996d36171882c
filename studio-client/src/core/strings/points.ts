// What is said of control points of any arrangement.

import type { Strings } from "./strings";

export const POINTS = {
  keepJoints: ["Take neighbours along, so that patches meet smoothly", "带动相邻控制点，使曲面片光滑相接"],
  take: ["A click takes", "点击选取"],
  take_point: ["Point", "单点"],
  take_ring: ["Ring", "环"],
  take_row: ["Spoke", "辐条"],
  take_layer: ["Layer", "层"],
  take_edge: ["Edge", "边"],
  take_face: ["Face", "面"],
  influence: ["Influence", "影响"],
  influenceUnit: ["share of its move", "随动比例"],
} as const satisfies Strings;
