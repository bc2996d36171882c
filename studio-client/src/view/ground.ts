// A grid on the ground that fades with distance: something for the shape to stand on.

import { Box3, Color, DoubleSide, Mesh, PlaneGeometry, ShaderMaterial, Vector3 } from "three";

const VERTEX = `
  varying vec2 place;
  void main() {
    place = position.xy;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const FRAGMENT = `
  varying vec2 place;
  uniform vec3 color;
  uniform float cells;
  float lines(float density) {
    vec2 at = place * density;
    vec2 width = fwidth(at);
    vec2 near = abs(fract(at - 0.5) - 0.5) / max(width, vec2(1e-6));
    float strength = 1.0 - min(min(near.x, near.y), 1.0);
    return strength * (1.0 - smoothstep(0.3, 0.9, max(width.x, width.y)));
  }
  void main() {
    float fade = 1.0 - smoothstep(0.12, 0.5, length(place));
    float strength = max(lines(cells) * 0.16, lines(cells / 5.0) * 0.38) * fade;
    if (strength < 0.004) discard;
    gl_FragColor = vec4(color, strength * 0.8);
  }`;

const SIZE = 6; // as often as the shape's diagonal

export class Ground {
  readonly object: Mesh<PlaneGeometry, ShaderMaterial>;

  constructor() {
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { color: { value: new Color() }, cells: { value: 60 } },
      transparent: true,
      depthWrite: false,
      side: DoubleSide,
    });
    this.object = new Mesh(new PlaneGeometry(1, 1), material);
    this.object.renderOrder = -1;
    this.object.visible = false;
  }

  setColor(color: Color): void {
    this.object.material.uniforms["color"]!.value = color;
  }

  /** Lie below a box, with round distances between the lines. */
  place(box: Box3, up: "y" | "z"): void {
    const diagonal = box.getSize(new Vector3()).length();
    const center = box.getCenter(new Vector3());
    const step = roundStep(diagonal / 8);
    const cells = Math.round((SIZE * diagonal) / step / 10) * 10;
    this.object.material.uniforms["cells"]!.value = cells;
    this.object.scale.setScalar(cells * step);
    const drop = diagonal * 0.003;
    if (up === "z") {
      this.object.rotation.set(0, 0, 0);
      this.object.position.set(center.x, center.y, box.min.z - drop);
    } else {
      this.object.rotation.set(-Math.PI / 2, 0, 0);
      this.object.position.set(center.x, box.min.y - drop, center.z);
    }
  }
}

/** 1, 2 or 5 times a power of ten, not above a length. */
export function roundStep(length: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(length, 1e-12)));
  const part = length / power;
  return (part >= 5 ? 5 : part >= 2 ? 2 : 1) * power;
}
