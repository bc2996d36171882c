// What the first-run guides say.

import type { Strings } from "./strings";

export const TOUR = {
  guides: ["Guides", "操作指引"],
  guidesText: ["A short walk through a mode:", "快速了解各个模式："],
  tourNext: ["Next", "下一步"],
  tourBack: ["Back", "上一步"],
  tourDone: ["Done", "完成"],
  tourSkip: ["Skip this guide", "跳过指引"],
  tourNever: ["No guides", "不再显示"],
  // look
  tourLookTurn: ["Turn it", "旋转视图"],
  tourLookTurnText: [
    "Drag to orbit, drag with the right button to pan, turn the wheel to zoom towards the pointer. F frames the shape.",
    "拖动旋转，右键拖动平移，滚轮向指针处缩放。按 F 居中显示。",
  ],
  tourLookAxes: ["Look along an axis", "沿坐标轴观察"],
  tourLookAxesText: ["Click an axis to look along it; P switches between perspective and parallel.", "点击坐标轴即可沿该方向观察；按 P 切换透视与正交。"],
  tourLookCompare: ["Before and after", "前后对比"],
  tourLookCompareText: [
    "Hold C for the shape as it was, or draw a divide across the canvas. Wireframe and shading stand here too.",
    "按住 C 查看原始形状，或在画布上拖动分隔线对比。线框与着色方式也在这里。",
  ],
  // control points
  tourPointsDrag: ["Drag a control point", "拖动控制点"],
  tourPointsDragText: [
    "The mesh follows while you drag. Shift-click takes several, Shift-drag draws a rectangle, Alt-click takes a whole layer.",
    "拖动时网格实时跟随。Shift 点击多选，Shift 拖动框选，Alt 点击选取整层。",
  ],
  tourPointsTools: ["Choose how they move", "选择移动方式"],
  tourPointsToolsText: [
    "Move, turn or scale what is selected; soft selection takes neighbours along; mirror works on both sides at once.",
    "对所选进行移动、旋转或缩放；软选择会带动邻近点；镜像可同时作用于两侧。",
  ],
  tourPointsLayers: ["Layers add up", "图层叠加"],
  tourPointsLayersText: [
    "Every deformer is a layer: add more with +, mute them, reorder them, or set their strength.",
    "每个变形器都是一个图层：用 + 添加，可静音、排序或调整强度。",
  ],
  tourPointsHistory: ["Nothing is lost", "不会丢失任何修改"],
  tourPointsHistoryText: ["Ctrl-Z undoes; a drag is one step. Click any line of the history to go back to it.", "Ctrl-Z 撤销；一次拖动为一步。点击历史中的任一行即可返回。"],
  // pull
  tourPullSurface: ["Take the surface itself", "直接拖动曲面"],
  tourPullSurfaceText: [
    "Press on the mesh and pull: the control points move as little as they must for that point to follow you.",
    "在网格上按住并拖动：控制点会以最小的移动使该点跟随指针。",
  ],
  tourPullEscape: ["Change your mind", "可以反悔"],
  tourPullEscapeText: [
    "Esc during a drag gives it up. A finer lattice pulls more locally: look at the layer that is selected.",
    "拖动中按 Esc 取消。晶格越细，影响越局部：请留意所选图层。",
  ],
} as const satisfies Strings;
