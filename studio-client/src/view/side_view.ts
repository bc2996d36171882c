// A second canvas beside the first: for a skeleton, for another shape. The two may share their point of view.

import { Vector3 } from "three";
import { h } from "../core/dom";
import { listenOn, type Taker } from "../modes/input";
import type { Studio } from "../studio";
import { Viewport } from "./viewport";

export class SideView {
  readonly viewport: Viewport;
  private readonly title = h("span", { class: "side-title" });
  private stage: HTMLElement | null = null;
  private stops: (() => void)[] = [];
  private linked = false;

  constructor(
    private readonly studio: Studio,
    title: string,
    taker: Taker,
    private readonly place: "left" | "right" = "right",
  ) {
    const context = studio.viewport.renderer.getContext().getContextAttributes();
    this.viewport = new Viewport(context?.antialias ?? true);
    this.title.textContent = title;
    this.viewport.element.classList.add("side", place);
    this.viewport.element.append(this.title);
    this.attach();
    this.stops.push(listenOn(this.viewport, () => taker), studio.settings.all.watch(() => this.applySettings()));
    this.fit();
  }

  setTitle(title: string): void {
    this.title.textContent = title;
  }

  /** Look from where the main view looks, and let that look from here. */
  link(): void {
    const { viewport } = this.studio;
    this.linked = true;
    this.stops.push(
      viewport.drawn.watch(() => this.follow(viewport, this.viewport)),
      this.viewport.drawn.onChange(() => this.follow(this.viewport, viewport)),
    );
  }

  close(): void {
    for (const stop of this.stops) stop();
    this.detach();
    this.viewport.dispose();
    this.fit();
  }

  /** The main view has another width: look at the whole shape again. */
  private fit(): void {
    requestAnimationFrame(() => requestAnimationFrame(() => this.studio.frame()));
  }

  private follow(from: Viewport, to: Viewport): void {
    if (!this.linked) return;
    const [one, two] = [from.cameras, to.cameras];
    two.setOrthographic(this.studio.settings.now.orthographic);
    const far =
      one.active.position.distanceTo(two.active.position) +
      one.target.distanceTo(two.target) +
      Math.abs(one.active.zoom - two.active.zoom);
    if (far < 1e-6 * one.active.position.distanceTo(one.target)) return;
    two.copy(one);
    to.request();
  }

  /** Stand where the main view stands: another language builds that place anew. */
  private attach(): void {
    const stage = this.studio.viewport.element.parentElement!;
    if (stage === this.stage) return;
    this.detach();
    this.stage = stage;
    this.studio.viewport.element.after(this.viewport.element); // under what floats over both
    stage.classList.add("split", `split-${this.place}`);
  }

  private detach(): void {
    this.stage?.classList.remove("split", `split-${this.place}`);
    this.viewport.element.remove();
  }

  private applySettings(): void {
    this.attach();
    const { now } = this.studio.settings;
    this.viewport.cameras.setUp(now.up);
    this.viewport.cameras.setOrthographic(now.orthographic);
    this.viewport.ground.setColor(this.studio.palette.ground);
    this.viewport.request();
  }

  /** Where a place of the scene is on the page. */
  onPage(at: Vector3): { x: number; y: number } {
    const box = this.viewport.canvas.getBoundingClientRect();
    const { x, y } = this.viewport.project(at);
    return { x: x + box.left, y: y + box.top };
  }
}
