// Small texts beside places of the scene; they follow the view.

import { Vector3 } from "three";
import { h, replace } from "../core/dom";
import type { Viewport } from "./viewport";

export interface Tag {
  at: Vector3;
  text: string;
  strong: boolean;
}

export class Tags {
  private readonly element = h("div", { class: "tags", "aria-hidden": "true" });
  private tags: Tag[] = [];
  private readonly stop: () => void;

  constructor(private readonly viewport: Viewport) {
    viewport.element.append(this.element);
    this.stop = viewport.drawn.onChange(() => this.place());
  }

  show(tags: Tag[]): void {
    this.tags = tags;
    replace(this.element, ...tags.map(({ text, strong }) => h("span", { class: strong ? "tag strong" : "tag" }, text)));
    this.place();
  }

  dispose(): void {
    this.stop();
    this.element.remove();
  }

  private place(): void {
    const { width, height } = this.viewport.size;
    this.tags.forEach(({ at }, i) => {
      const each = this.element.children[i] as HTMLElement;
      const { x, y, depth } = this.viewport.project(at);
      each.hidden = Math.abs(depth) > 1 || x < 0 || y < 0 || x > width || y > height || !this.viewport.helpers.visible;
      const left = x + 24 + each.offsetWidth > width ? x - 12 - each.offsetWidth : x + 12;
      each.style.translate = `${Math.round(left)}px ${Math.round(y) - 11}px`;
    });
  }
}
