// What deformation transfer says.

import type { Strings } from "./strings";

export const TRANSFER = {
  modeTransfer: ["Transfer poses", "姿态迁移"],
  hintTransfer: [
    "Click a place on the source, then the same place on the target: a pair. Drag to turn either view.",
    "先点击源网格上的位置，再点击目标网格上的相同位置，组成一对。拖动可旋转视图。",
  ],
  sourceShape: ["Source", "源网格"],
  transferIntro: [
    "Load a mesh that has poses: its files at rest and in each pose, or a project. Your shape will take the poses too.",
    "载入带有姿态的网格：静止与各姿态的文件，或一个项目。您的网格将采用这些姿态。",
  ],
  loadSource: ["Load the source …", "载入源网格…"],
  otherSource: ["Another source …", "更换源网格…"],
  tryExample: ["Try an example", "试用示例"],
  addPoses: ["Add poses …", "添加姿态…"],
  markers: ["Markers", "标记"],
  markersHint: [
    "Click the same place on both shapes. A dozen or more, at ends and bends.",
    "在两个网格上点击相同的位置。建议在端点和弯曲处放置十几对。",
  ],
  loadMarkers: ["Load …", "载入…"],
  compute: ["Transfer the poses", "迁移姿态"],
  computeAgain: ["Transfer again", "再次迁移"],
  needsPoses: ["The source has no pose yet.", "源网格还没有姿态。"],
  needsMarkers: ["At least three pairs of markers are needed.", "至少需要三对标记。"],
  poses: ["Poses", "姿态"],
  playPoses: ["Play", "播放"],
  pausePoses: ["Pause", "暂停"],
  exportPoses: ["Export all …", "全部导出…"],
  onlyThisPose: ["This pose only", "仅此姿态"],
  did_transfer: ["Transfer", "迁移"],
  did_play: ["Mix", "混合"],
  transferTour1: ["A source with poses", "带姿态的源网格"],
  transferTour1Text: [
    "Load a mesh at rest together with the same mesh in other poses, or a project with a clip. It appears on the left.",
    "载入静止网格及其各姿态，或带动画的项目。它会显示在左侧。",
  ],
  transferTour2: ["Markers in pairs", "成对标记"],
  transferTour2Text: [
    "Click a place on the source and the same place on your shape. Numbers and colours show what belongs together.",
    "点击源网格上的位置和您的网格上的相同位置。编号和颜色表示对应关系。",
  ],
  transferTour3: ["Compute, then play", "计算并播放"],
  transferTour3Text: [
    "The poses become a layer of your shape: mix them by sliders, play them with the space bar, export them.",
    "姿态会成为您网格的一个图层：可用滑块混合、按空格播放并导出。",
  ],
} as const satisfies Strings;
