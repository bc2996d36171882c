// A quantity on the surface as colours: the number travels, the table is looked up here, so that the legend matches.

import { DataTexture, DoubleSide, LinearFilter, NoColorSpace, RGBAFormat, ShaderMaterial, Vector2 } from "three";

const VERTEX = `
  attribute float scalar;
  varying float value;
  varying vec3 bend;
  varying vec3 seen;
  void main() {
    value = scalar;
    bend = normalMatrix * normal;
    vec4 place = modelViewMatrix * vec4(position, 1.0);
    seen = -place.xyz;
    gl_Position = projectionMatrix * place;
  }`;

// Shading only darkens a little, at the rim: a colour must stay readable.
const FRAGMENT = `
  varying float value;
  varying vec3 bend;
  varying vec3 seen;
  uniform sampler2D table;
  uniform vec2 range;
  uniform bool flat_;
  void main() {
    float part = clamp((value - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
    vec3 color = texture2D(table, vec2((part * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    vec3 normal = flat_ ? normalize(cross(dFdx(seen), dFdy(seen))) : normalize(bend);
    float facing = abs(dot(normal, normalize(seen)));
    gl_FragColor = vec4(color * (0.66 + 0.34 * smoothstep(0.0, 0.75, facing)), 1.0);
  }`;

export class ColorMap {
  readonly material: ShaderMaterial;
  table = new Uint8Array(256 * 4);
  private texture: DataTexture;

  constructor() {
    this.texture = this.newTexture();
    this.material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: DoubleSide,
      uniforms: {
        table: { value: this.texture },
        range: { value: new Vector2(0, 1) },
        flat_: { value: false },
      },
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
  }

  /** (256, 3) colours from low to high. */
  setTable(colors: ArrayLike<number>): void {
    for (let i = 0; i < 256; i++) {
      for (let k = 0; k < 3; k++) this.table[4 * i + k] = colors[3 * i + k]!;
      this.table[4 * i + 3] = 255;
    }
    this.texture.needsUpdate = true;
  }

  setRange(low: number, high: number): void {
    (this.material.uniforms["range"]!.value as Vector2).set(low, high);
  }

  setFlat(flat: boolean): void {
    this.material.uniforms["flat_"]!.value = flat;
  }

  private newTexture(): DataTexture {
    const texture = new DataTexture(this.table, 256, 1, RGBAFormat);
    texture.colorSpace = NoColorSpace;
    texture.minFilter = texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
  }
}

/** (n, 3) colours as (n, 4), opaque. */
export function withAlpha(table: Uint8Array): Uint8Array {
  const out = new Uint8Array((table.length / 3) * 4).fill(255);
  for (let i = 0; i < table.length / 3; i++) out.set(table.subarray(3 * i, 3 * i + 3), 4 * i);
  return out;
}
