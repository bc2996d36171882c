// The pictures of the gallery: asked for when they come into view, and kept moving as long as there is time for it.

import { Vector3 } from "three";
import { Latest } from "../../transport/latest";
import type { Studio } from "../../studio";
import { Motion, SmallStage } from "../../view/small_stage";

const BUDGET = 9; // milliseconds of a frame
const [WIDTH, HEIGHT] = [300, 208];

export interface Wanted {
  intensity: number;
  replace: boolean;
}

interface Picture {
  name: string;
  canvas: HTMLCanvasElement;
  seen: boolean;
  motion: Motion | null;
}

export class MovingCards {
  private readonly pictures = new Map<Element, Picture>();
  private readonly stage: SmallStage;
  private readonly watcher: IntersectionObserver;
  private readonly latest = new Latest<number>(() => this.load());
  private readonly still = matchMedia("(prefers-reduced-motion: reduce)");
  private turn = 0;
  private rest = 0;
  private running = true;
  private version = 0;
  /** Told which pictures cannot be drawn, and why. */
  onFailure: (card: Element, why: string) => void = () => undefined;

  constructor(
    private readonly studio: Studio,
    private wanted: Wanted,
  ) {
    const { palette, viewport, settings } = studio;
    const up = settings.now.up === "y" ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
    this.stage = new SmallStage(WIDTH, HEIGHT, palette.clay, viewport.cameras.direction(), up);
    this.watcher = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const picture = this.pictures.get(target);
        if (picture) picture.seen = isIntersecting;
      }
      this.latest.push(0);
    });
    const tick = (): void => {
      if (!this.running) return;
      this.draw();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  add(name: string, card: Element, canvas: HTMLCanvasElement): void {
    [canvas.width, canvas.height] = [WIDTH, HEIGHT];
    this.pictures.set(card, { name, canvas, seen: false, motion: null });
    this.watcher.observe(card);
  }

  /** Draw them all anew, otherwise. */
  want(wanted: Wanted): void {
    this.wanted = wanted;
    this.version++;
    for (const picture of this.pictures.values()) this.forget(picture);
    this.latest.push(0);
  }

  end(): void {
    this.running = false;
    this.watcher.disconnect();
    for (const picture of this.pictures.values()) this.forget(picture);
    this.pictures.clear();
    this.stage.dispose();
  }

  private forget(picture: Picture): void {
    picture.motion?.geometry.dispose();
    picture.motion = null;
  }

  private async load(): Promise<void> {
    const { version, studio } = this;
    for (;;) {
      const next = [...this.pictures].find(([, { seen, motion }]) => seen && !motion);
      if (!next || !this.running || version !== this.version) return;
      const [card, picture] = next;
      try {
        const { head, arrays } = await studio.session.ask("templates.preview", { name: picture.name, ...this.wanted, up: studio.settings.now.up });
        if (version !== this.version || !this.running) return;
        const [positions, normals, triangles] = ["positions", "normals", "triangles"].map((name) => arrays[name]!) as [Float32Array, Int8Array, Uint32Array];
        picture.motion = new Motion(positions, normals, triangles, head["moments"] as number, head["period"] as number);
        this.stage.draw(picture.motion, 0.35 * picture.motion.period, picture.canvas);
        card.classList.add("drawn");
      } catch (error) {
        this.pictures.delete(card);
        this.onFailure(card, error instanceof Error ? error.message : String(error));
      }
    }
  }

  /** As many as there is time for, each in its turn; who wants no motion sees only what the pointer is on move. */
  private draw(): void {
    const began = performance.now();
    if (began < this.rest) return;
    const moving = [...this.pictures].filter(([card, { seen, motion }]) => seen && motion && (!this.still.matches || card.matches(":hover, :focus")));
    for (let i = 0; i < moving.length && performance.now() - began < BUDGET; i++) {
      const [, { motion, canvas }] = moving[this.turn++ % moving.length]!;
      this.stage.draw(motion!, began / 1000, canvas);
    }
    const spent = performance.now() - began;
    this.rest = spent > 2 * BUDGET ? began + 4 * spent : 0; // without a graphics card: leave time for the rest of the page
  }
}
