// What is said of round lattices.

import type { Strings } from "./strings";

export const EXTENDED = {
  newRound: ["New round lattice", "新建环形晶格"],
  roundKind: ["Shape", "形状"],
  cylinder: ["Cylinder", "圆柱"],
  prism: ["Prism", "棱柱"],
  sphere: ["Sphere", "球"],
  roundAround: ["Around", "环向"],
  roundSides: ["Sides", "边数"],
  roundOut: ["Outwards", "径向"],
  roundAlong: ["Along", "轴向"],
  roundPoles: ["From pole to pole", "极间"],
  controlPointsCount: ["control points", "个控制点"],
} as const satisfies Strings;
