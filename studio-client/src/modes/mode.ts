// A mode: what the pointer and the keys mean, and a panel. A new one registers itself here, and stands in the rail.

import type { IconName } from "../core/icons";
import type { StringKey } from "../core/strings";
import type { TourStep } from "../panels/tour";
import type { Studio } from "../studio";
import type { KeyLine } from "./key_lists";

/** Where the pointer is on the canvas, in CSS pixels from its upper left corner. */
export interface Pointer {
  x: number;
  y: number;
  shift: boolean;
  alt: boolean;
  ctrl: boolean;
  touch: boolean;
}

export type Probe = Record<string, (...values: never[]) => unknown>;

export interface Mode {
  readonly id: string;
  readonly icon: IconName;
  readonly title: StringKey;
  readonly hint: StringKey;
  readonly shortcut: string;
  /** What the help sheet says of it. */
  readonly shortcuts?: readonly KeyLine[];
  enter(): void;
  leave(): void;
  /** True where the mode takes the pointer, which then does not turn the view. */
  down?(pointer: Pointer): boolean;
  move?(pointer: Pointer): void;
  up?(pointer: Pointer): void;
  hover?(pointer: Pointer): void;
  /** True where the key is used up. */
  key?(event: KeyboardEvent): boolean;
  /** Take back what is no entry of the history; true where there was something. */
  undo?(): boolean;
  /** What stands above the canvas while the mode is on. */
  toolbar?(): HTMLElement;
  /** What stands under the canvas while the mode is on. */
  dock?(): HTMLElement;
  /** A section of the inspector. */
  panel?(): { title: StringKey; body: HTMLElement };
  /** The steps of its first-run guide. */
  tour?(): TourStep[];
  /** The box of what is selected, to be framed. */
  selectionBox?(): import("three").Box3 | null;
  /** What tests in a browser read of the mode: `window.pliantStudio.probes[id]`. */
  readonly probe?: Probe;
}

export type ModeMaker = (studio: Studio) => Mode;

const makers: ModeMaker[] = [];

export function registerMode(maker: ModeMaker): void {
  makers.push(maker);
}

export const makeModes = (studio: Studio): Mode[] => makers.map((make) => make(studio));
