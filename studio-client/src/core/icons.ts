// Icons of our own: strokes on a 20 x 20 grid, coloured by the text around them.

const PATHS = {
  logo: "M3 5.5 10 2l7 3.5v9L10 18l-7-3.5zM3 5.5 10 9l7-3.5M10 9v9",
  open: "M3 15.5v-11h5l2 2h7v9z",
  save: "M4 3.5h9.5l2.5 2.5v10.5H4zM7 3.5v4h5v-4M6.5 16.5v-5h7v5",
  export: "M10 12.5V3M6.5 6 10 2.5 13.5 6M4 10.5v6h12v-6",
  import: "M10 2.5V12M6.5 9 10 12.5 13.5 9M4 11.5v5h12v-5",
  undo: "M7.5 4 3.5 8l4 4M4 8h7.5a4.5 4.5 0 0 1 0 9H8",
  redo: "M12.5 4 16.5 8l-4 4M16 8H8.5a4.5 4.5 0 0 0 0 9H12",
  orbit: "M10 3.5v13M3.5 10h13M10 3.5 8 5.5M10 3.5l2 2M10 16.5l-2-2M10 16.5l2-2M3.5 10l2-2M3.5 10l2 2M16.5 10l-2-2M16.5 10l-2 2",
  points: "M4.5 4.5h11v11h-11zM10 4.5v11M4.5 10h11",
  pull: "M4 16c4 0 4-9 8-10M12 6h4M14 4l2 2-2 2M3 16h2",
  view: "M2.5 10S5.5 5 10 5s7.5 5 7.5 5-3 5-7.5 5-7.5-5-7.5-5zM10 8a2 2 0 1 1 0 4 2 2 0 0 1 0-4z",
  hidden: "M2.5 10S5.5 5 10 5s7.5 5 7.5 5-3 5-7.5 5-7.5-5-7.5-5zM4 16 16 4",
  solo: "M10 3.5a6.5 6.5 0 1 1 0 13 6.5 6.5 0 0 1 0-13zM10 8a2 2 0 1 1 0 4 2 2 0 0 1 0-4z",
  plus: "M10 4v12M4 10h12",
  minus: "M4 10h12",
  close: "M5 5l10 10M15 5 5 15",
  trash: "M4 6h12M8 6V4h4v2M5.5 6l.8 10.5h7.4L14.5 6M8.5 9v5M11.5 9v5",
  grip: "M7.5 5h.01M12.5 5h.01M7.5 10h.01M12.5 10h.01M7.5 15h.01M12.5 15h.01",
  chevron: "M7.5 5l5 5-5 5",
  down: "M5 7.5l5 5 5-5",
  move: "M10 3v14M3 10h14M8 5l2-2 2 2M8 15l2 2 2-2M5 8l-2 2 2 2M15 8l2 2-2 2",
  rotate: "M15.5 6.5A6.5 6.5 0 1 0 16.5 10M16 3v4h-4",
  scale: "M4 10.5V16h5.5M16 9.5V4h-5.5M4 16l5-5M16 4l-5 5",
  rectangle: "M4 6V4h2M9 4h2M14 4h2v2M16 9v2M16 14v2h-2M11 16H9M6 16H4v-2M4 11V9",
  soft: "M2.5 15.5c4 0 4.5-11 7.5-11s3.5 11 7.5 11",
  mirror: "M10 3v14M7.5 6 3.5 14h4zM12.5 6l4 8h-4z",
  magnet: "M5 4v6a5 5 0 0 0 10 0V4h-3v6a2 2 0 0 1-4 0V4zM5 7h3M12 7h3",
  lock: "M5.5 9h9v7.5h-9zM7.5 9V6.5a2.5 2.5 0 0 1 5 0V9",
  layer: "M10 3.5 17 7l-7 3.5L3 7zM3.5 10.5 10 14l6.5-3.5M3.5 13.5 10 17l6.5-3.5",
  history: "M3.5 10A6.5 6.5 0 1 1 5.5 14.7M3.5 10 2 8M3.5 10l2-1.8M10 6.5V10l2.5 2",
  field: "M3 5c3-1.5 4 1.5 7 0s4 1.5 7 0M3 10c3-1.5 4 1.5 7 0s4 1.5 7 0M3 15c3-1.5 4 1.5 7 0s4 1.5 7 0",
  arrows: "M3.5 16.5l5-5M5 11h3.5v3.5M11.5 8.5l5-5M13 3.5h3.5V7",
  palette: "M10 3a7 7 0 1 0 0 14c1.5 0 1.5-1 1-2-.6-1.2.2-2.5 1.5-2.5H15c1.5 0 2-1.5 2-3A6.8 6.8 0 0 0 10 3zM6.5 9h.01M9 6h.01M13 7h.01",
  frame: "M3.5 7V3.5H7M13 3.5h3.5V7M16.5 13v3.5H13M7 16.5H3.5V13M8 8h4v4H8z",
  compare: "M10 2.5v15M3.5 5h4v10h-4zM12.5 5h4v10h-4z",
  camera: "M3 6.5h3l1.5-2h5l1.5 2h3v9H3zM10 8a3 3 0 1 1 0 6 3 3 0 0 1 0-6z",
  sun: "M10 6.5a3.5 3.5 0 1 1 0 7 3.5 3.5 0 0 1 0-7zM10 2v1.5M10 16.5V18M2 10h1.5M16.5 10H18M4.3 4.3l1 1M14.7 14.7l1 1M4.3 15.7l1-1M14.7 5.3l1-1",
  moon: "M15.5 12A6.5 6.5 0 0 1 8 4.5a6 6 0 1 0 7.5 7.5z",
  language: "M10 3a7 7 0 1 1 0 14 7 7 0 0 1 0-14zM3 10h14M10 3c2.5 2 2.5 12 0 14M10 3c-2.5 2-2.5 12 0 14",
  help: "M10 3a7 7 0 1 1 0 14 7 7 0 0 1 0-14zM8 8a2 2 0 1 1 2.8 1.8c-.6.3-.8.7-.8 1.4M10 13.5h.01",
  settings: "M3 6h8M15 6h2M13 4v4M3 14h2M9 14h8M7 12v4",
  warning: "M10 3.5 17.5 16.5h-15zM10 8v4.5M10 14.5h.01",
  check: "M4 10.5l4 4 8-9",
  wire: "M3 10 10 3l7 7-7 7zM3 10h14M10 3v14",
  shade: "M10 3a7 7 0 1 1 0 14 7 7 0 0 1 0-14zM10 3v14M12 4v12M14 5.5v9",
  home: "M3 9.5 10 3.5l7 6M5 8.5v8h10v-8",
  reset: "M4.5 8A6 6 0 1 1 4 11M4.5 3.5V8H9",
  cube: "M10 2.5 16.5 6v8L10 17.5 3.5 14V6zM3.5 6 10 9.5 16.5 6M10 9.5v8",
  surface: "M2.5 13c3-8 6-1 8-4s3-5 7-4M8 8.5V3.5M6 5.5l2-2 2 2",
  lasso: "M10 3.5c4 0 7 1.8 7 4.5s-3 4.5-7 4.5-7-1.8-7-4.5 3-4.5 7-4.5zM6 12c-1.5 1-1.5 3 0 3s2 1.5 1 2.5",
  brush: "M16.5 3.5 9 11M11 13 7 9c-2 .5-2.5 2-2.5 3.5S4 15.5 3 16.5c3.5 0 7-.5 8-3.5z",
  ripple: "M10 9a1 1 0 1 1 0 2 1 1 0 0 1 0-2zM10 6a4 4 0 1 1 0 8 4 4 0 0 1 0-8zM10 3a7 7 0 1 1 0 14 7 7 0 0 1 0-14z",
  through: "M3.5 6.5h9v9h-9zM7.5 6V3.5h9v9H13M6 9h4M6 12h4",
  region: "M4 8c1-4 7-5 10-2s2 9-3 10-8-4-7-8z",
  transfer: "M2.5 6.5h9M9 4l2.5 2.5L9 9M17.5 13.5h-9M11 11l-2.5 2.5 2.5 2.5M14.5 4.5h2.5v4M5.5 16H3v-4",
  pause: "M7 4.5v11M13 4.5v11",
  ortho: "M3.5 7h9v9.5h-9zM7.5 7V3.5h9V13h-4",
  target: "M10 5a5 5 0 1 1 0 10 5 5 0 0 1 0-10zM10 2v4M10 14v4M2 10h4M14 10h4",
  cage: "M10 2 17 6.5v7L10 18l-7-4.5v-7zM3 6.5 10 10l7-3.5M10 10v8M3 13.5 10 10l7 3.5M10 2v8",
  sites: "M10 3.5h.01M4.5 8h.01M15.5 7h.01M8 12h.01M14 14.5h.01M5.5 16h.01M10 3.5 4.5 8 8 12l6 2.5 1.5-7.5zM4.5 8l1 8L8 12l7.5-5M5.5 16 14 14.5",
  twist: "M5 3c0 4 10 5 10 7s-10 3-10 7M15 3c0 4-10 5-10 7s10 3 10 7M6.5 5.5h7M6.5 14.5h7",
  bend: "M3.5 16.5v-3a10 10 0 0 1 10-10h3M8.5 16.5v-3a5 5 0 0 1 5-5h3M3.5 16.5h5M16.5 3.5v5",
  taper: "M3.5 16.5h13M7.5 3.5h5M3.5 16.5l4-13M16.5 16.5l-4-13M5.5 10h9",
  flare: "M4 3.5h12M4 16.5h12M4 3.5c3.5 3 3.5 10 0 13M16 3.5c-3.5 3-3.5 10 0 13",
  squash: "M3 7h14v6H3zM10 1.5V5M8.5 3.5 10 5l1.5-1.5M10 18.5V15M8.5 16.5 10 15l1.5 1.5",
  sine: "M2.5 10c1.3-6 3.7-6 5 0s3.7 6 5 0 3.7-6 5 0",
  wave: "M10 8.5a1.5 1.5 0 1 1 0 3 1.5 1.5 0 0 1 0-3zM10 5.5a4.5 4.5 0 1 1 0 9 4.5 4.5 0 0 1 0-9zM10 2.5a7.5 7.5 0 1 1 0 15 7.5 7.5 0 0 1 0-15z",
  model: "M2.5 15.5c4 0 4.5-11 7.5-11s3.5 11 7.5 11zM10 4.5v11M5.8 15.5c2.4 0 2.6-5.5 4.2-5.5s1.8 5.5 4.2 5.5",
  face: "M10 2.5c3.6 0 5.5 2.6 5.5 6.2 0 4.6-2.6 8.8-5.5 8.8s-5.5-4.2-5.5-8.8C4.5 5.1 6.4 2.5 10 2.5zM7.5 8.2h1M11.5 8.2h1M10 8.5v3l-.8.3M8 14c1.2.8 2.8.8 4 0",
  dice: "M4 4h12v12H4zM7 7h.01M13 7h.01M10 10h.01M7 13h.01M13 13h.01",
  time: "M10 3a7 7 0 1 1 0 14 7 7 0 0 1 0-14zM10 6v4.5l3 2",
  play: "M6 4l10 6-10 6z",
  first: "M5 4v12M15.5 4.5 8 10l7.5 5.5z",
  last: "M15 4v12M4.5 4.5 12 10l-7.5 5.5z",
  previous: "M6.5 10 9 7.5l2.5 2.5L9 12.5zM4 4v12M16 6l-3 4 3 4",
  next: "M8.5 10 11 7.5l2.5 2.5L11 12.5zM16 4v12M4 6l3 4-3 4",
  record: "M10 5a5 5 0 1 1 0 10 5 5 0 0 1 0-10z",
  key: "M10 4.5 15.5 10 10 15.5 4.5 10z",
  film: "M3.5 4.5h13v11h-13zM7 4.5v11M13 4.5v11M3.5 8H7M3.5 12H7M13 8h3.5M13 12h3.5",
  template: "M3.5 3.5h5.5v5.5H3.5zM11 3.5h5.5v5.5H11zM3.5 11h5.5v5.5H3.5zM11 13.8h5.5M13.8 11v5.5",
  pin: "M8 3h4l-.5 5 3 3h-9l3-3zM10 11v6",
  onion: "M7.5 4.5a5.5 5.5 0 1 0 0 11M12.5 4.5a5.5 5.5 0 1 1 0 11 5.5 5.5 0 0 1 0-11zM10 4a8 8 0 0 0 0 12",
  file: "M5 2.5h6.5L15.5 6.5v11H5zM11.5 2.5v4h4",
} as const;

export type IconName = keyof typeof PATHS;

const SVG = "http://www.w3.org/2000/svg";

export function icon(name: IconName, size = 18): SVGSVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 20 20");
  svg.setAttribute("width", String(size));
  svg.setAttribute("height", String(size));
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}
