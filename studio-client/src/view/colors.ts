// The colours of what is drawn, by theme; the page's own colours are in the style sheet.

import { Color } from "three";

export interface Palette {
  clay: Color;
  wire: Color;
  handle: Color;
  selected: Color;
  region: Color;
  soft: Color;
  locked: Color;
  hovered: Color;
  lattice: Color;
  grid: Color;
  ground: Color;
  target: Color;
}

const LIGHT: Palette = {
  clay: new Color("#c6cfdb"),
  wire: new Color("#2b3442"),
  handle: new Color("#ee9a2b"),
  selected: new Color("#e0305a"),
  region: new Color("#3f7fe0"),
  soft: new Color("#f4c04e"),
  locked: new Color("#8b94a3"),
  hovered: new Color("#ffc76b"),
  lattice: new Color("#7b8596"),
  grid: new Color("#128a80"),
  ground: new Color("#8f9bb0"),
  target: new Color("#e08a2c"),
};

const DARK: Palette = {
  clay: new Color("#aab6c8"),
  wire: new Color("#0d1117"),
  handle: new Color("#f2a53c"),
  selected: new Color("#ff4d78"),
  region: new Color("#4f8df0"),
  soft: new Color("#f7d06e"),
  locked: new Color("#6d7787"),
  hovered: new Color("#ffd58f"),
  lattice: new Color("#69758a"),
  grid: new Color("#3fc9bb"),
  ground: new Color("#5a6880"),
  target: new Color("#f0a552"),
};

export const paletteOf = (dark: boolean): Palette => (dark ? DARK : LIGHT);
