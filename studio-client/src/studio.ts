// What all parts of the studio share: the session, the canvas, what is selected, and how failures are told.

import { Box3, Vector3 } from "three";
import { SettingsStore } from "./core/settings";
import { Signal } from "./core/signal";
import { t } from "./core/strings";
import type { Mode } from "./modes/mode";
import { Toasts } from "./panels/toasts";
import type { Layer, SceneState } from "./transport/protocol";
import { CommandError, Session } from "./transport/session";
import type { Transport } from "./transport/transport";
import type { Frame, Numbers } from "./transport/frame";
import { paletteOf } from "./view/colors";
import { FieldView } from "./view/field_view";
import { MeshView } from "./view/mesh_view";
import { Viewport } from "./view/viewport";

/** Numbers at the points that a mode paints the surface with, and the colours that they stand for. */
export interface Paint {
  title: string;
  unit: string;
  low: number;
  high: number;
  values: Float32Array;
  table: Numbers;
}

export interface StudioOptions {
  antialias: boolean;
  /** Where the page's theme is set. */
  root: HTMLElement;
}

export class Studio {
  readonly settings = new SettingsStore();
  readonly session: Session;
  readonly viewport: Viewport;
  readonly mesh: MeshView;
  readonly field = new FieldView();
  readonly toasts = new Toasts();
  readonly activeLayer = new Signal<string | null>(null);
  readonly mode = new Signal<Mode | null>(null);
  /** The mesh has been drawn anew, or some of its points have moved. */
  readonly meshLoaded = new Signal(0);
  readonly pointsMoved = new Signal(0);
  /** What a mode paints the surface with, in place of the field's colours. */
  readonly paint = new Signal<Paint | null>(null);
  /** What stays under the canvas in all modes. */
  readonly pinned = new Signal<HTMLElement | null>(null);
  readonly root: HTMLElement;
  /** Open files that were chosen, as if they had been dropped; set by the page. */
  take: (files: File[]) => void = () => undefined;
  /** Enter a mode; set by the page. */
  enter: (mode: string) => void = () => undefined;

  constructor(transport: Transport, options: StudioOptions) {
    this.root = options.root;
    this.session = new Session(transport);
    this.viewport = new Viewport(options.antialias);
    this.mesh = new MeshView(() => this.viewport.request());
    this.viewport.shape.add(this.mesh.object);
    this.viewport.helpers.add(this.field.object);
    this.session.scene.watch((scene) => this.keepActive(scene));
    this.settings.all.watch(() => this.applySettings());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.applySettings());
  }

  get scene(): SceneState | null {
    return this.session.scene.value;
  }

  get layer(): Layer | null {
    return this.scene?.layers.find((layer) => layer.name === this.activeLayer.value) ?? null;
  }

  get palette(): ReturnType<typeof paletteOf> {
    return paletteOf(this.settings.dark);
  }

  /** Ask the server; a failure is told as a toast, and gives null. */
  async ask(
    command: string,
    values: Record<string, unknown> = {},
    arrays: Record<string, Numbers> = {},
  ): Promise<Frame | null> {
    try {
      return await this.session.ask(command, values, arrays);
    } catch (error) {
      this.tell(error);
      return null;
    }
  }

  tell(error: unknown): void {
    if (error instanceof CommandError && error.kind === "Disconnected") return; // the status line says so
    this.toasts.error(error instanceof Error ? error.message : String(error));
  }

  /** The bounding box of the shape as it is, or of a selection. */
  frame(box?: Box3, from?: Vector3): void {
    const whole = box ?? this.mesh.box;
    if (!whole.isEmpty()) this.viewport.frame(whole, from);
  }

  private keepActive(scene: SceneState | null): void {
    const names = scene?.layers.map((layer) => layer.name) ?? [];
    if (this.activeLayer.value === null || !names.includes(this.activeLayer.value)) {
      this.activeLayer.set(names.at(-1) ?? null);
    }
  }

  private applySettings(): void {
    const { now, dark } = this.settings;
    this.root.dataset["theme"] = dark ? "dark" : "light";
    this.mesh.apply(now, this.palette);
    this.field.setColor(this.palette.grid);
    this.viewport.ground.setColor(this.palette.ground);
    this.viewport.ground.object.visible = now.ground && (this.scene?.mesh ?? null) !== null;
    this.viewport.cameras.setUp(now.up);
    this.viewport.cameras.setOrthographic(now.orthographic);
    this.placeGround();
    this.viewport.request();
  }

  placeGround(viewport = this.viewport): void {
    const facts = this.scene?.mesh;
    if (!facts) return;
    const [low, high] = facts.bounds;
    viewport.ground.place(
      new Box3(new Vector3().fromArray(low), new Vector3().fromArray(high)),
      this.settings.now.up,
    );
    viewport.ground.object.visible = this.settings.now.ground;
  }

  get title(): string {
    return this.scene?.name ?? t("untitled");
  }
}
