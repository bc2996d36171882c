// Outlines on the screen while something is picked: a rectangle, a lasso, the ring of a brush.

import type { Viewport } from "./viewport";

const SVG = "http://www.w3.org/2000/svg";

export class Outline {
  private readonly svg = document.createElementNS(SVG, "svg");
  private readonly path = document.createElementNS(SVG, "path");
  private readonly ring = document.createElementNS(SVG, "circle");

  constructor(viewport: Viewport) {
    this.svg.setAttribute("class", "outline");
    this.svg.append(this.path, this.ring);
    viewport.element.append(this.svg);
    this.clear();
  }

  /** A closed polygon of pixels, one coordinate after the other. */
  polygon(places: readonly number[]): void {
    const corners = Array.from({ length: places.length / 2 }, (_, i) => `${places[2 * i]},${places[2 * i + 1]}`);
    this.path.setAttribute("d", corners.length ? `M${corners.join("L")}Z` : "");
  }

  circle(x: number, y: number, radius: number): void {
    this.ring.setAttribute("cx", String(x));
    this.ring.setAttribute("cy", String(y));
    this.ring.setAttribute("r", String(radius));
    this.ring.style.display = "";
  }

  clear(): void {
    this.path.setAttribute("d", "");
    this.ring.style.display = "none";
  }

  dispose(): void {
    this.svg.remove();
  }
}
