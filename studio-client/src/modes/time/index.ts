// Time: keys, curves and the playhead under the canvas; ghosts of other moments; the tool's way over the object.

import type { TourStep } from "../../panels/tour";
import { openExport } from "../../panels/export_dialog";
import { openTemplates } from "../../panels/templates/gallery";
import type { Studio } from "../../studio";
import { TIME_KEYS } from "../key_lists";
import { registerMode, type Mode, type Probe } from "../mode";
import { ClipModel } from "./clip_model";
import { Dock } from "./dock";
import { Ghosts } from "./ghosts";
import { KeyPanel } from "./key_panel";
import { Placer } from "./placer";
import { TimeTools } from "./tools";
import type { Tool } from "../../view/gizmo";

class TimeMode implements Mode {
  readonly id = "time";
  readonly icon = "time";
  readonly title = "modeTime";
  readonly hint = "hintTime";
  readonly shortcut = "t";
  readonly shortcuts = TIME_KEYS;
  private readonly model: ClipModel;
  private readonly keys: KeyPanel;
  private readonly timeline: Dock;
  private readonly ghosts: Ghosts;
  private readonly placer: Placer;
  private readonly tools: TimeTools;

  constructor(studio: Studio) {
    this.model = new ClipModel(studio);
    this.keys = new KeyPanel(this.model);
    this.ghosts = new Ghosts(this.model);
    this.placer = new Placer(studio);
    this.tools = new TimeTools(this.model, this.placer, this.ghosts);
    this.timeline = new Dock(this.model, {
      templates: () => void openTemplates(studio, this.model.player.time.value),
      film: () => openExport(studio, "motion"),
      pin: (on) => studio.pinned.set(on ? this.timeline.element : null),
    });
  }

  enter(): void {
    this.timeline.request();
    this.ghosts.start();
  }

  leave(): void {
    this.model.player.pause();
    this.ghosts.stop();
    this.placer.stop();
  }

  toolbar(): HTMLElement {
    return this.tools.bar();
  }

  hover(): void {
    this.placer.useCamera();
  }

  dock(): HTMLElement {
    this.timeline.request();
    return this.timeline.element;
  }

  panel(): { title: "timeSelectedKeys"; body: HTMLElement } {
    return { title: "timeSelectedKeys", body: this.keys.element };
  }

  key(event: KeyboardEvent): boolean {
    const { model } = this;
    switch (event.key) {
      case " ":
        model.player.toggle();
        return true;
      case ",":
        model.toKey(-1);
        return true;
      case ".":
        model.toKey(1);
        return true;
      case "ArrowLeft":
      case "ArrowRight":
        void model.player.step(event.key === "ArrowLeft" ? -1 : 1);
        return true;
      case "Delete":
      case "Backspace":
        void model.removeSelected();
        return true;
      case "d":
        void model.double();
        return true;
      case "k":
        this.keys.setKeys();
        return true;
      case "g":
      case "r":
      case "s":
        if (!this.placer.on) return false;
        this.tools.setTool({ g: "translate", r: "rotate", s: "scale" }[event.key] as Tool);
        return true;
      case "Escape":
        if (!this.placer.cancel()) model.selection.choose([]);
        return true;
      default:
        return false;
    }
  }

  tour(): TourStep[] {
    return [
      { at: ".ruler", title: "tourTimeScrub", text: "tourTimeScrubText" },
      { at: ".transport .record", title: "tourTimeRecord", text: "tourTimeRecordText" },
      { at: ".time-area", title: "tourTimeKeys", text: "tourTimeKeysText" },
      { at: ".stage-top .toolbar", title: "tourTimePlace", text: "tourTimePlaceText" },
      { at: ".dock-corner", title: "tourTimeCurves", text: "tourTimeCurvesText" },
    ];
  }

  get probe(): Probe {
    const { player, selection } = this.model;
    return {
      time: () => player.time.value,
      playing: () => player.playing.value,
      kept: () => player.kept.value,
      selected: () => selection.list,
      ghosts: () => this.ghosts.count,
      gizmo: () => this.placer.screen,
      x: (time: number) => this.model.span.x(time),
    } as Probe;
  }
}

registerMode((studio) => new TimeMode(studio));
