// Planes across limbs, drawn as lines on the screen: the line while it is drawn, and the rings that the planes give.

import { h } from "../../core/dom";
import type { Studio } from "../../studio";
import { Latest } from "../../transport/latest";
import type { Pointer } from "../mode";
import type { Plans } from "./plan";

const TRIES = 15; // places along the line where the limb is looked for

export class Planes {
  private readonly line = h("div", { class: "cage-line", hidden: true });
  private from: Pointer | null = null;
  private readonly latest = new Latest<null>(() => this.fetch());
  private shown = false;
  private wanted = true;

  constructor(
    private readonly studio: Studio,
    private readonly plans: Plans,
    private readonly tell: (message: string) => void,
  ) {}

  enter(): void {
    this.studio.viewport.element.append(this.line);
  }

  leave(): void {
    this.line.remove();
    this.hide();
  }

  get drawing(): boolean {
    return this.from !== null;
  }

  begin(pointer: Pointer): void {
    this.from = pointer;
  }

  stretch(pointer: Pointer): void {
    const from = this.from!;
    const [wide, high] = [pointer.x - from.x, pointer.y - from.y];
    this.line.hidden = false;
    Object.assign(this.line.style, {
      left: `${from.x}px`,
      top: `${from.y}px`,
      width: `${Math.hypot(wide, high)}px`,
      rotate: `${Math.atan2(high, wide)}rad`,
    });
  }

  async end(pointer: Pointer, failed: string): Promise<void> {
    const from = this.from!;
    this.from = null;
    this.line.hidden = true;
    const inside = this.inside(from, pointer);
    if (!inside) {
      this.studio.toasts.error(failed);
      return;
    }
    const ray = ({ x, y }: Pointer): number[] => {
      const { origin, direction } = this.studio.viewport.ray(x, y).ray;
      return [...origin.toArray(), ...direction.toArray()];
    };
    const answer = await this.studio.ask("cage.cut", { inside, first: ray(from), second: ray(pointer) });
    if (answer) this.plans.change({ cuts: [...this.plans.now.cuts, answer.head["cut"] as number[]] });
  }

  cancel(): void {
    this.from = null;
    this.line.hidden = true;
  }

  /** Show the rings of the planes so far, or nothing: where there is a cage, they have done their part. */
  show(wanted = this.wanted): void {
    this.wanted = wanted;
    if (wanted && this.plans.now.method === "cuts" && this.plans.now.cuts.length) this.latest.push(null);
    else {
      this.hide();
      this.tell("");
    }
  }

  /** The middle of what the line crosses: between where the eye's ray enters the shape and where it leaves. */
  private inside(from: Pointer, to: Pointer): number[] | null {
    const { viewport, mesh } = this.studio;
    const found: number[][] = [];
    for (let i = 0; i < TRIES; i++) {
      const part = i / (TRIES - 1);
      const hits = viewport.ray(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)).intersectObject(mesh.target, false);
      if (hits[0]) found.push((hits[1] ?? hits[0]).point.clone().add(hits[0].point).multiplyScalar(0.5).toArray());
    }
    return found[Math.floor(found.length / 2)] ?? null;
  }

  private async fetch(): Promise<void> {
    const answer = await this.studio.ask("cage.sketch", ...this.plans.asked);
    if (!answer || !this.wanted || this.plans.now.method !== "cuts" || !this.line.isConnected) return;
    this.studio.field.setPreview(answer.arrays["points"] as Float32Array, answer.arrays["links"] as Uint32Array);
    this.shown = true;
    this.tell(answer.head["message"] as string);
    this.studio.viewport.request();
  }

  private hide(): void {
    if (!this.shown) return;
    this.shown = false;
    this.studio.field.setPreview(null, new Uint32Array());
    this.studio.viewport.request();
  }
}
