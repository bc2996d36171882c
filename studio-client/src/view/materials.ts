// Materials of the mesh, and their textures, which arrive as the bytes of picture files.

import { Color, DoubleSide, MeshPhongMaterial, RepeatWrapping, SRGBColorSpace, Texture } from "three";
import type { Palette } from "./colors";
import { MarkColors } from "./marks";
import type { Settings } from "../core/settings";

export interface MaterialFacts {
  name: string;
  color: [number, number, number] | null;
  texture: number | null;
}

export class MaterialSet {
  private readonly marks = new MarkColors();
  list: MeshPhongMaterial[] = [this.plain()];
  onChange: () => void = () => undefined;
  private facts: MaterialFacts[] = [];
  private readonly textures = new Map<number, Texture>();
  private settings: Settings | null = null;
  private palette: Palette | null = null;

  load(facts: MaterialFacts[], hasUVs: boolean): void {
    for (const material of this.list) material.dispose();
    for (const texture of this.textures.values()) texture.dispose();
    this.textures.clear();
    this.facts = facts.map((each) => ({ ...each, texture: hasUVs ? each.texture : null }));
    this.list = facts.length ? facts.map(() => this.plain()) : [this.plain()];
    this.refresh();
  }

  /** The textures that the mesh uses, to be asked for. */
  get wanted(): number[] {
    return [...new Set(this.facts.map((each) => each.texture).filter((id) => id !== null))];
  }

  async setTexture(id: number, bytes: Uint8Array): Promise<void> {
    const picture = await createImageBitmap(new Blob([bytes as Uint8Array<ArrayBuffer>]), { imageOrientation: "flipY" });
    const texture = new Texture(picture);
    texture.flipY = false; // bitmaps are turned when they are decoded
    texture.colorSpace = SRGBColorSpace;
    texture.wrapS = texture.wrapT = RepeatWrapping;
    texture.anisotropy = 8;
    texture.needsUpdate = true;
    this.textures.set(id, texture);
    this.refresh();
    this.onChange();
  }

  apply(settings: Settings, palette: Palette): void {
    this.settings = settings;
    this.palette = palette;
    this.marks.set(palette.region, palette.selected);
    this.refresh();
  }

  private refresh(): void {
    this.list.forEach((material, i) => {
      const facts = this.facts[i];
      const map = (this.settings?.texture !== false && facts && facts.texture !== null && this.textures.get(facts.texture)) || null;
      if (material.map !== map || material.flatShading !== (this.settings?.shading === "flat")) {
        material.map = map;
        material.flatShading = this.settings?.shading === "flat";
        material.needsUpdate = true;
      }
      if (map) material.color.set(0xffffff);
      else if (facts?.color && this.settings?.texture !== false) material.color.setRGB(...facts.color, SRGBColorSpace);
      else material.color.copy(this.palette?.clay ?? new Color(0xcccccc));
    });
  }

  private plain(): MeshPhongMaterial {
    const material = new MeshPhongMaterial({
      specular: 0x1c1f24,
      shininess: 38,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    this.marks.teach(material);
    return material;
  }
}
