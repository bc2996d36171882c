// What a person prefers, kept by the browser: theme, language, how things are drawn.

import { Signal } from "./signal";

export type Theme = "light" | "dark" | "auto";
export type Language = "en" | "zh-CN";
export type Shading = "smooth" | "flat";

export interface Settings {
  theme: Theme;
  language: Language;
  shading: Shading;
  texture: boolean;
  wireframe: boolean;
  ground: boolean;
  orthographic: boolean;
  up: "y" | "z";
  /** Whether modes that are new to this person explain themselves, and which have. */
  guides: boolean;
  guided: string[];
  /** How high the timeline is, in pixels. */
  timeline: number;
}

const KEY = "pliant-studio";

const DEFAULTS: Settings = {
  theme: "auto",
  language: "en",
  shading: "smooth",
  texture: true,
  wireframe: false,
  ground: true,
  orthographic: false,
  up: "z",
  guides: true,
  guided: [],
  timeline: 236,
};

export class SettingsStore {
  readonly all: Signal<Settings>;

  constructor() {
    this.all = new Signal({ ...DEFAULTS, language: preferredLanguage(), ...stored() });
  }

  get now(): Settings {
    return this.all.value;
  }

  change(part: Partial<Settings>): void {
    this.all.set({ ...this.all.value, ...part });
    try {
      localStorage.setItem(KEY, JSON.stringify(this.all.value));
    } catch {
      // private windows keep nothing
    }
  }

  get dark(): boolean {
    const { theme } = this.now;
    return theme === "dark" || (theme === "auto" && matchMedia("(prefers-color-scheme: dark)").matches);
  }
}

function preferredLanguage(): Language {
  return navigator.language.toLowerCase().startsWith("zh") ? "zh-CN" : "en";
}

function stored(): Partial<Settings> {
  try {
    const found: unknown = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return typeof found === "object" && found !== null ? (found as Partial<Settings>) : {};
  } catch {
    return {};
  }
}
