// Faces: a photograph becomes the shape, and sliders make its caricature.

import { Vector3 } from "three";
import type { Studio } from "../../studio";
import { Latest } from "../../transport/latest";
import type { Layer } from "../../transport/protocol";
import { Dots } from "../../view/dots";
import { FACE_KEYS } from "../key_lists";
import { registerMode, type Mode } from "../mode";
import { FacePanel, type FaceFacts } from "./panel";
import { faceTour } from "./tour";

const KIND = "face-caricature";

class FaceMode implements Mode {
  readonly id = "face";
  readonly icon = "face";
  readonly title = "modeFace";
  readonly hint = "hintFace";
  readonly shortcut = "h";
  readonly shortcuts = FACE_KEYS;
  readonly tour = faceTour;
  readonly probe = {
    landmark: (index: number) => [...(this.landmarks?.slice(3 * index, 3 * index + 3) ?? [])],
    dots: () => this.dots?.visible ?? false,
    facts: () => ({ ...this.facts }),
    ready: () => this.layer !== null && this.settled,
  };
  private dots: Dots | null = null;
  private landmarks: Float32Array | null = null;
  private shown = true;
  private settled = false;
  private mesh: number | null = null;
  private upBefore: "y" | "z" | null = null;
  private stops: (() => void)[] = [];
  private facts: FaceFacts = { missing: "", example: false, number: 0, count: 1, least: 1, folds: false };
  private readonly side: FacePanel;
  private readonly following = new Latest<null>(() => this.follow());
  private readonly looking = new Latest<null>(() => this.lookForFolds());

  constructor(private readonly studio: Studio) {
    this.side = new FacePanel(studio, {
      landmarks: (on) => {
        this.shown = on;
        this.draw();
      },
      handles: () => void this.addHandles(),
    });
    studio.meshLoaded.onChange(() => this.turnBack());
  }

  /** The caricature: of the active layer, or the first there is. */
  private get layer(): Layer | null {
    const { layer, scene } = this.studio;
    return layer?.kind === KIND ? layer : (scene?.layers.find((each) => each.kind === KIND) ?? null);
  }

  enter(): void {
    const { studio } = this;
    this.dots = new Dots(studio.viewport);
    this.stops = [
      studio.session.scene.onChange(() => this.refresh()),
      studio.activeLayer.onChange(() => this.refresh()),
      studio.pointsMoved.onChange(() => this.following.push(null)),
      studio.meshLoaded.onChange(() => this.turn()),
      studio.settings.all.onChange(() => this.draw()),
    ];
    void this.prepare();
    this.turn();
    this.refresh();
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.dots?.dispose();
    this.dots = this.landmarks = null;
  }

  panel(): { title: "modeFace"; body: HTMLElement } {
    this.showPanel();
    return { title: "modeFace", body: this.side.element };
  }

  private async prepare(): Promise<void> {
    const answer = await this.studio.ask("face.ready");
    if (!answer) return;
    this.facts = { ...this.facts, missing: answer.head["missing"] as string, example: answer.head["example"] as boolean };
    this.showPanel();
  }

  /** Faces look along z, and their up is y: seen from the front when they come. */
  private turn(): void {
    const { scene, settings } = this.studio;
    const id = scene?.mesh?.id ?? null;
    if (!this.layer || id === this.mesh) return;
    this.mesh = id;
    if (settings.now.up !== "y") {
      this.upBefore = settings.now.up;
      settings.change({ up: "y" });
    }
    this.studio.frame(undefined, new Vector3(0.3, 0.12, 1));
  }

  /** Other shapes stand as they did before a face came. */
  private turnBack(): void {
    if (this.layer || this.upBefore === null) return;
    this.studio.settings.change({ up: this.upBefore });
    this.upBefore = null;
  }

  private refresh(): void {
    this.settled = false;
    this.showPanel();
    this.following.push(null);
    this.looking.push(null);
  }

  /** Landmarks go with the shape. */
  private async follow(): Promise<void> {
    const { layer } = this;
    const answer = layer ? await this.studio.ask("face.get", { layer: layer.name }) : null;
    this.landmarks = (answer?.arrays["landmarks"] as Float32Array | undefined) ?? null;
    if (answer) {
      const { number, count } = answer.head as { number: number; count: number };
      if (number !== this.facts.number || count !== this.facts.count) {
        this.facts = { ...this.facts, number, count };
        this.showPanel();
      }
    }
    this.draw();
  }

  private async lookForFolds(): Promise<void> {
    const { layer } = this;
    const answer = layer ? await this.studio.ask("face.folds", { layer: layer.name }) : null;
    if (answer) {
      const { least, folds } = answer.head as { least: number; folds: boolean };
      this.facts = { ...this.facts, least, folds };
    }
    this.settled = true;
    this.showPanel();
  }

  private async addHandles(): Promise<void> {
    const { layer, studio } = this;
    const answer = layer ? await studio.ask("face.handles", { layer: layer.name }) : null;
    if (!answer) return;
    studio.activeLayer.set(answer.head["layer"] as string);
    studio.enter("points");
  }

  private draw(): void {
    this.dots?.show(this.shown ? this.landmarks : null, this.studio.palette.grid);
  }

  private showPanel(): void {
    this.side.show(this.layer, this.facts, this.shown);
  }
}

registerMode((studio) => new FaceMode(studio));
