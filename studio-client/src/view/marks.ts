// Marks on the surface: which points are in a region, and which of them are its handle, as colours over the material.

import type { Color, MeshPhongMaterial } from "three";

export const IN_REGION = 1;
export const IN_HANDLE = 2;

const VERTEX = `
  #include <begin_vertex>
  marked = mark.xy;`;

// A mark ends between the points that have it and those that have not, with a sharp line.
const FRAGMENT = `
  #include <color_fragment>
  {
    vec2 width = fwidth(marked) * 0.7 + 1e-4;
    vec2 inside = smoothstep(0.5 - width, 0.5 + width, marked);
    diffuseColor.rgb = mix(diffuseColor.rgb, regionColor, 0.62 * inside.x * (1.0 - inside.y));
    diffuseColor.rgb = mix(diffuseColor.rgb, handleColor, 0.85 * inside.y);
  }`;

/** The colours of marks, shared by all materials that show them. */
export class MarkColors {
  private readonly uniforms: { regionColor: { value: Color | null }; handleColor: { value: Color | null } } = {
    regionColor: { value: null },
    handleColor: { value: null },
  };

  set(region: Color, handle: Color): void {
    this.uniforms.regionColor.value = region;
    this.uniforms.handleColor.value = handle;
  }

  /** Let a material show marks. */
  teach(material: MeshPhongMaterial): void {
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = `attribute vec4 mark;\nvarying vec2 marked;\n${shader.vertexShader}`.replace(
        "#include <begin_vertex>",
        VERTEX,
      );
      shader.fragmentShader =
        `varying vec2 marked;\nuniform vec3 regionColor;\nuniform vec3 handleColor;\n${shader.fragmentShader}`.replace(
          "#include <color_fragment>",
          FRAGMENT,
        );
    };
  }
}

/** Marks as the graphics card reads them: four bytes a point. */
export function markBytes(marks: Uint8Array): Uint8Array {
  const bytes = new Uint8Array(4 * marks.length);
  marks.forEach((mark, i) => {
    if (mark & IN_REGION) bytes[4 * i] = 255;
    if (mark & IN_HANDLE) bytes[4 * i + 1] = 255;
  });
  return bytes;
}
