// The three axes in the corner: they show which way is up, and a click looks along one of them.

import { Quaternion, Vector3 } from "three";
import { t } from "../core/strings";
import type { Viewport } from "./viewport";

const SIZE = 92;
const ARM = 33;
const SVG = "http://www.w3.org/2000/svg";

interface Ball {
  direction: Vector3;
  group: SVGGElement;
  line: SVGLineElement | null;
}

export function axisGizmo(viewport: Viewport): SVGSVGElement {
  const svg = svgElement("svg", { viewBox: `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`, width: SIZE, height: SIZE });
  svg.setAttribute("class", "axis-gizmo");
  const balls = ["x", "y", "z"].flatMap((axis, i) => [1, -1].map((sign) => ball(viewport, axis, i, sign)));
  const shown = new Quaternion(0, 0, 0, 0);
  const follow = (): void => {
    if (shown.equals(viewport.camera.quaternion)) return; // most drawings are of another shape, not from elsewhere
    const inverse = shown.copy(viewport.camera.quaternion).clone().invert();
    const seen = balls.map((each) => ({ each, at: each.direction.clone().applyQuaternion(inverse) }));
    seen.sort((a, b) => a.at.z - b.at.z);
    for (const { each, at } of seen) {
      each.group.setAttribute("transform", `translate(${at.x * ARM} ${-at.y * ARM})`);
      each.group.style.opacity = String(0.55 + 0.45 * ((at.z + 1) / 2));
      each.line?.setAttribute("x2", String(-at.x * ARM));
      each.line?.setAttribute("y2", String(at.y * ARM));
      svg.append(each.group);
    }
  };
  viewport.drawn.watch(follow);
  return svg;
}

function ball(viewport: Viewport, axis: string, i: number, sign: number): Ball {
  const direction = new Vector3().setComponent(i, sign);
  const group = svgElement("g", { class: `axis-ball axis-${axis} ${sign > 0 ? "positive" : "negative"}` });
  group.setAttribute("role", "button");
  group.setAttribute("tabindex", "0");
  group.setAttribute("aria-label", `${t("viewFrom")} ${sign > 0 ? "+" : "−"}${axis}`);
  let line: SVGLineElement | null = null;
  if (sign > 0) {
    line = svgElement("line", { x1: 0, y1: 0, x2: 0, y2: 0 });
    group.append(line);
  }
  group.append(svgElement("circle", { r: sign > 0 ? 9.5 : 7 }));
  if (sign > 0) {
    const label = svgElement("text", { "text-anchor": "middle", dy: "0.35em" });
    label.textContent = axis.toUpperCase();
    group.append(label);
  }
  const look = (): void => viewport.cameras.lookFrom(direction.clone());
  group.addEventListener("click", look);
  group.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") look();
  });
  return { direction, group, line };
}

function svgElement<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number>,
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}
