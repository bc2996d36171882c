// A handle for tests in a browser: what is drawn, and where things are on the screen.

import { Vector3 } from "three";
import type { App } from "./app";
import { latencies } from "./modes/layer_drag";
import type { Probe } from "./modes/mode";
import type { PointsMode } from "./modes/points";

export interface TestHandle {
  readonly revision: number;
  readonly frames: number;
  /** Whether something has changed that is not drawn yet. */
  readonly waiting: boolean;
  readonly latencies: number[];
  controlPoint: (index: number) => { x: number; y: number } | null;
  controlPosition: (index: number) => number[] | null;
  selection: () => number[];
  gizmoRadius: () => number;
  vertex: (index: number) => { x: number; y: number };
  position: (index: number) => number[];
  /** Colours of a rectangle of the canvas, in CSS pixels of the page: rows from below, four bytes a pixel. */
  pixels: (x: number, y: number, width: number, height: number) => number[];
  look: (x: number, y: number, z: number) => void;
  mode: (id: string) => void;
  probes: Record<string, Probe>;
  skipDrawing: (skip: boolean) => void;
  drag: (index: number, moves: number, step: [number, number, number]) => Promise<void>;
}

declare global {
  interface Window {
    pliantStudio?: TestHandle;
  }
}

export function exposeForTests({ studio, modes, setMode }: App): void {
  const points = modes.find((mode) => mode.id === "points") as PointsMode;
  const { viewport, mesh } = studio;
  const position = (index: number): number[] => [...mesh.positions.slice(3 * index, 3 * index + 3)];
  const onPage = (at: { x: number; y: number } | null): { x: number; y: number } | null => {
    const box = viewport.canvas.getBoundingClientRect();
    return at && { x: at.x + box.left, y: at.y + box.top };
  };
  window.pliantStudio = {
    get revision() {
      return studio.scene?.revision ?? -1;
    },
    get frames() {
      return viewport.drawn.value;
    },
    get waiting() {
      return viewport.waiting;
    },
    latencies,
    controlPoint: (index) => onPage(points.screen(index)),
    controlPosition: (index) => points.points?.at(index).toArray() ?? null,
    selection: () => [...(points.points?.selected ?? [])].sort((a, b) => a - b),
    gizmoRadius: () => points.gizmoRadius,
    vertex: (index) => onPage(viewport.project(new Vector3(...(position(index) as [number, number, number]))))!,
    position,
    pixels: (x, y, width, height) => {
      const { left, top } = viewport.canvas.getBoundingClientRect();
      return viewport.read(x - left, y - top, width, height);
    },
    look: (x, y, z) => studio.frame(undefined, new Vector3(x, y, z)),
    mode: setMode,
    probes: Object.fromEntries(modes.flatMap((mode) => (mode.probe ? [[mode.id, mode.probe]] : []))),
    skipDrawing: (skip) => {
      viewport.skipDrawing = skip;
    },
    drag: (index, moves, step) => points.dragBySteps(index, moves, new Vector3(...step)),
  };
}
