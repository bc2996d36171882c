// What the mode of cages says.

import type { Strings } from "./strings";

export const CAGE = {
  modeCage: ["Cages", "笼式变形"],
  hintCage: [
    "Build a cage, then drag its vertices, edges or faces. Soft selection takes neighbours along.",
    "先构建笼网格，再拖动其顶点、边或面。软选择会带动相邻部分。",
  ],
  cageAutomatic: ["Automatic", "自动"],
  cagePlanes: ["Planes", "切面"],
  cageBox: ["Box", "盒"],
  vertexBudget: ["Vertices, at most", "顶点上限"],
  symmetry: ["Symmetry", "对称"],
  coordinates: ["Coordinates", "坐标"],
  coordinates_mean_value: ["Mean value", "均值坐标"],
  coordinates_green: ["Green", "格林坐标"],
  coordinates_harmonic: ["Harmonic", "调和坐标"],
  coordinates_maximum_entropy: ["Maximum entropy", "最大熵坐标"],
  coordinates_quad_mean_value: ["Mean value, quads", "四边形均值坐标"],
  coordinates_quad_green: ["Green, quads", "四边形格林坐标"],
  buildCage: ["Build the cage", "构建笼网格"],
  drawPlanes: [
    "Draw lines across the limbs: each makes a plane along the view, with a ring around what it cuts.",
    "在肢体上画线：每条线沿视线方向形成一个切面，并在截面外生成一个环。",
  ],
  drawingPlanes: ["Drags draw; Alt turns the view", "拖动即画线；Alt 拖动旋转视图"],
  plane: ["Plane", "切面"],
  planeLeftOut: ["No ring on plane", "以下切面没有环："],
  planeMissed: ["That line misses the shape: draw it across a limb.", "该线没有经过形状：请画过肢体。"],
  ringSides: ["Corners of a ring", "环的角数"],
  cageChecking: ["Looking at the cage …", "正在检查笼网格…"],
  cageEncloses: ["Encloses the shape", "完全包住形状"],
  cageManifold: ["Closed and manifold", "封闭且为流形"],
  cageSimple: ["Does not cut itself", "无自相交"],
  cageVolume: ["the shape's volume", "倍体积"],
  compareCoordinates: ["Compare coordinates", "比较坐标"],
  cageBeside: ["Side by side", "并排比较"],
  cageBesideToo: ["And beside", "再并排"],
  compareLegend: [
    "Distance from the present shape, in its diagonals, and volume kept. Click one to see where.",
    "与当前形状的距离（占对角线）及保留的体积。点击查看分布。",
  ],
  did_coordinates: ["Coordinates of", "更换坐标"],
  cageTourBuild: ["Build a cage", "构建笼网格"],
  cageTourBuildText: [
    "Choose how many vertices it may have. It is built in the background, and checked: it encloses the shape, is closed, and does not cut itself.",
    "选择顶点上限。构建在后台进行并自动检查：包住形状、封闭、无自相交。",
  ],
  cageTourPlanes: ["Or by planes", "或用切面构建"],
  cageTourPlanesText: [
    "Draw lines across arms and legs; rings go around the cuts and are linked along the limbs.",
    "在四肢上画线；切口外会生成环，并沿肢体相连。",
  ],
  cageTourDrag: ["Vertices, edges, faces", "顶点、边、面"],
  cageTourDragText: [
    "Choose above what a click takes, then drag it or use the gizmo. Compare what other coordinates make of the same edit.",
    "在上方选择点击选取的对象，然后拖动或使用操纵器。可比较不同坐标对同一编辑的结果。",
  ],
} as const satisfies Strings;
