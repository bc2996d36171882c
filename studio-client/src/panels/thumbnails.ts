// Small drawings of the examples.

const SVG = "http://www.w3.org/2000/svg";

/** Strokes on a 120 x 80 sheet; those after the bar are fainter. */
const DRAWINGS: Record<string, [string, string]> = {
  vase: [
    "M47 70h26M48 70c-3-6-13-14-11-26 1-8 9-11 9-19 0-5-4-7-7-10h42c-3 3-7 5-7 10 0 8 8 11 9 19 2 12-8 20-11 26",
    "M37 44c8 4 38 4 46 0M40 57c8 4 32 4 40 0M46 25c6 3 22 3 28 0M60 15v55M50 15c2 8-6 40 0 55M70 15c-2 8 6 40 0 55",
  ],
  torus: [
    "M60 18c24 0 40 10 40 22s-16 22-40 22-40-10-40-22 16-22 40-22zM42 38c4 7 32 7 36 0M45 41c4-6 26-6 30 0",
    "M60 18c6 4 6 18 0 25M60 62c-8-4-8-12 0-16M21 36c10-2 17 0 22 5M99 36c-10-2-17 0-22 5M32 25c9 4 12 8 14 14M88 25c-9 4-12 8-14 14",
  ],
  sphere: [
    "M60 12a28 28 0 1 1 0 56 28 28 0 0 1 0-56z",
    "M32 40c8 8 48 8 56 0M36 26c8 6 40 6 48 0M36 54c8 6 40 6 48 0M60 12c-16 12-16 44 0 56M60 12c16 12 16 44 0 56",
  ],
  bar: [
    "M14 34 82 20l26 12-68 16zM14 34v18l26 14V48M40 66l68-16V32",
    "M31 30.5l26 13.5v18M48 27l26 13v18M65 23.5 91 36v18M27 41v18.5l68-16",
  ],
  "varying-head": [
    "M60 12c15 0 22 11 22 24 0 8-4 12-6 18-3 7-8 14-16 14s-13-7-16-14c-2-6-6-10-6-18 0-13 7-24 22-24z",
    "M60 6c19 0 28 13 28 29 0 9-5 15-7 21-3 9-11 18-21 18s-18-9-21-18c-2-6-7-12-7-21C32 19 41 6 60 6zM60 19c11 0 16 8 16 17 0 6-3 10-4 14-2 6-6 11-12 11s-10-5-12-11c-1-4-4-8-4-14 0-9 5-17 16-17z",
  ],
  astronaut: [
    "M60 10c14 0 22 9 22 24 0 18-10 36-22 36S38 52 38 34c0-15 8-24 22-24zM51 53c5 5 13 5 18 0z",
    "M46 33c3-3 7-3 10 0-3 3-7 3-10 0zM64 33c3-3 7-3 10 0-3 3-7 3-10 0zM60 33v10l-3 2M45 27c3-2 8-2 11 0M64 27c3-2 8-2 11 0",
  ],
  "bent-bar": [
    "M24 16h16c0 20 8 30 20 30s20-10 20-30h16c0 30-14 46-36 46S24 46 24 16zM24 16l6-6h16l-6 6M80 16l6-6h16l-6 6M102 10c0 12-2 22-6 30",
    "M26 30l16-2M32 46l13-9M46 58l8-13M60 62V46M74 58l-8-13M88 46l-13-9M94 30l-16-2",
  ],
  "sited-egg": [
    "M58 10c15 0 26 14 26 32 0 16-11 28-26 28S32 58 32 42c0-18 11-32 26-32zM84 38c8-1 14 1 17 5-5 4-11 5-18 3",
    "M50 24h.01M66 30h.01M44 42h.01M60 48h.01M74 44h.01M52 60h.01M68 60h.01M50 24l16 6 8 14-6 16-16 0-8-18zM66 30 44 42l16 6 14-4M60 48l-8 12M60 48l8 12",
  ],
  "caged-vase": [
    "M42 68h20l6-18-6-16 10-16H52l-4 16-10 16zM52 18c4 3 16 3 20 0",
    "M34 72h32l6-2M34 72V52l4-18 8-22h32l-8 22-4 18v20M38 34h32M34 52h32M46 12l6-4h32l-6 4M84 8l-8 22-4 18v22M70 34l6-4M66 52l6-4",
  ],
  head: [
    "M60 10c17 0 25 12 25 26 0 8-4 13-6 19-3 8-10 15-19 15s-16-7-19-15c-2-6-6-11-6-19 0-14 8-26 25-26z",
    "M60 10v60M36 34c8 6 40 6 48 0M38 46c8 6 36 6 44 0M44 58c6 4 26 4 32 0M47 14c-6 18-6 36 3 53M73 14c6 18 6 36-3 53",
  ],
};

export function thumbnail(name: string): Node {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 120 80");
  svg.setAttribute("class", "thumbnail");
  svg.setAttribute("aria-hidden", "true");
  const drawing = DRAWINGS[name] ?? DRAWINGS["sphere"]!;
  drawing.forEach((strokes, i) => {
    const path = document.createElementNS(SVG, "path");
    path.setAttribute("d", strokes);
    if (i === 1) path.setAttribute("class", "faint");
    svg.append(path);
  });
  return svg;
}
