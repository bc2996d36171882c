// What the mode of sites says.

import type { Strings } from "./strings";

export const SITES = {
  modeSites: ["Sites", "自由控制点"],
  hintSites: [
    "Click the surface to place a site, then drag it. The colours show how far the selected site reaches. Delete removes it.",
    "点击曲面放置控制点，然后拖动。颜色表示所选点的影响范围。Delete 删除。",
  ],
  noSites: ["Click the surface twice or more: each click is a control point.", "在曲面上点击两次以上：每次点击放置一个控制点。"],
  scatter: ["Scatter", "散布"],
  scatterNow: ["Scatter over the surface", "散布到曲面"],
  smoothSites: ["Smooth at the sites (Farin)", "控制点处光滑（Farin）"],
  mirrorSites: ["Other side", "另一侧"],
  newSites: ["New layer", "新图层"],
  deleteSites: ["Delete selected", "删除所选"],
  did_sites: ["Sites of", "控制点"],
  sitesTourPlace: ["Click the surface", "点击曲面"],
  sitesTourPlaceText: [
    "Each click puts a control point there. A drag that begins on the surface still turns the view.",
    "每次点击都会放置一个控制点；在曲面上按住拖动仍是旋转视图。",
  ],
  sitesTourDrag: ["Drag a site", "拖动控制点"],
  sitesTourDragText: [
    "Its natural neighbours hold the rest. The colours show how much of its move each place makes.",
    "其自然邻点会保持其余部分。颜色表示各处随动的比例。",
  ],
  sitesTourPanel: ["Scatter, mirror, smooth", "散布、镜像、平滑"],
  sitesTourPanelText: [
    "Scatter sites evenly, copy them to the other side, or make the deformation smooth at the sites too.",
    "可均匀散布、复制到另一侧，或让控制点处也保持光滑。",
  ],
} as const satisfies Strings;
