// The keys and gestures of each mode, as the help sheet lists them.

import type { StringKey } from "../core/strings";

/** Keys, two spaces between those that are separate, and what they do. */
export type KeyLine = readonly [string, StringKey];

const TOOLS: KeyLine[] = [
  ["G  R  S", "key_tools"],
  ["X  Y  Z", "key_axis"],
];

const LOCAL: KeyLine = ["L", "key_local"];

const SELECTING: KeyLine[] = [
  ["B  Shift-drag", "key_rectangle"],
  ["Shift-click", "key_grow"],
  ["A", "key_all"],
  ["O", "key_soft"],
  ["N", "key_snap"],
];

export const POINT_KEYS: readonly KeyLine[] = [
  ...TOOLS,
  LOCAL,
  ...SELECTING,
  ["Alt-click", "key_layer"],
  ["J", "keepJoints"],
  ["Delete", "key_reset"],
  ["Esc", "key_escape"],
];

export const SITE_KEYS: readonly KeyLine[] = [
  ["Click", "key_site"],
  ["Delete", "key_siteRemove"],
  ...TOOLS,
  ...SELECTING,
  ["Esc", "key_escape"],
];

export const CAGE_KEYS: readonly KeyLine[] = [
  ["Drag", "key_plane"],
  ...TOOLS,
  ...SELECTING,
  ["Delete", "key_reset"],
  ["Esc", "key_escape"],
];

export const PULL_KEYS: readonly KeyLine[] = [
  ["Drag", "key_pull"],
  ["Esc", "key_giveUp"],
];

export const SURFACE_KEYS: readonly KeyLine[] = [
  ["B  L  D  E", "key_pickers"],
  ["Shift  Alt", "key_addRemove"],
  ["[  ]", "key_brush"],
  ["H", "key_into"],
  ["V", "key_through"],
  ["+  −", "key_rings"],
  ...TOOLS,
  ["M", "key_method"],
  ["K", "key_skeleton"],
  ["Right-drag", "key_turnWhilePicking"],
  ["Esc", "key_escape"],
];

export const AXIAL_KEYS: readonly KeyLine[] = [
  ["Drag", "key_handles"],
  ["N", "key_snap"],
  ["Ctrl", "key_snapWhile"],
  ["Esc", "key_giveUp"],
];

export const TRANSFER_KEYS: readonly KeyLine[] = [
  ["Click", "key_pair"],
  ["Esc", "key_forget"],
  ["Space", "key_play"],
];

export const MODEL_KEYS: readonly KeyLine[] = [
  ["Click", "key_landmark"],
  ["Shift-click", "key_grow"],
  ["Delete", "key_landmarkRemove"],
  ["U", "key_uncertainty"],
  ["Alt-drag", "key_turnOver"],
  ["Double-click", "key_slider"],
  ["Esc", "key_escape"],
];

export const FACE_KEYS: readonly KeyLine[] = [
  ["Drop", "key_photo"],
  ["Double-click", "key_slider"],
];

export const TIME_KEYS: readonly KeyLine[] = [
  ["Space", "key_play"],
  ["←  →", "key_frames"],
  [",  .", "key_toKeys"],
  ["K", "key_setKey"],
  ["D", "key_copyKeys"],
  ["Delete", "key_removeKeys"],
  ["Alt-drag", "key_offFrames"],
  ["Ctrl-wheel  Shift-wheel", "key_ruler"],
  ["G  R  S", "key_place"],
  ["Esc", "key_escape"],
];
