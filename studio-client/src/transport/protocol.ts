// What travels: the scene as the server tells it, and what there is to choose from.

export type FieldType =
  | "number"
  | "integer"
  | "angle"
  | "length"
  | "vector"
  | "axis"
  | "choice"
  | "bool"
  | "text"
  | "profile"
  | "array"
  | "deformer"
  | "deformers"
  | "mesh"
  | "object";

export interface Field {
  name: string;
  type: FieldType;
  unit: string;
  default: unknown;
  required: boolean;
  control: boolean;
  range: [number, number] | null;
  choices: string[];
  doc: string;
}

export interface FieldValue extends Field {
  value: unknown;
  editable: boolean;
}

export interface Kind {
  name: string;
  title: string;
  summary: string;
  group: string;
  makers: Record<string, Field[]>;
}

export interface Layer {
  name: string;
  kind: string;
  title: string;
  muted: boolean;
  solo: boolean;
  envelope: number;
  fields: FieldValue[];
  /** How many control points can be dragged, and their arrangement where they stand in a lattice. */
  points: number;
  shape: [number, number, number] | null;
  linear: boolean;
  transform: boolean;
  /** Whether it has an axis to take hold of. */
  axial: boolean;
}

export interface MeshFacts {
  id: number;
  name: string;
  points: number;
  faces: number;
  bounds: [number[], number[]];
  center: number[];
  diagonal: number;
  textured: boolean;
  closed: boolean;
  /** Groups, objects, materials and selections, around which a lattice can be laid. */
  parts: string[];
}

export interface ClipKey {
  time: number;
  /** A number a component; of what has more than three, how far it has come. */
  value: number[];
  easing: string | [number, number, number, number];
}

export interface TrackState {
  layer: string;
  field: string;
  /** Whether the values themselves are told, and can be set. */
  plain: boolean;
  /** What stands after its values, which are as people see them. */
  unit: string;
  keys: ClipKey[];
  /** The curves between the keys, one a component: their heights at these times. */
  times: number[];
  curves: number[][];
}

export interface ClipState {
  /** Whether the scene has it, or it is what one would begin with. */
  exists: boolean;
  duration: number;
  fps: number;
  ending: "once" | "loop" | "ping-pong";
  intensity: number;
  amplify: number;
  motion: boolean;
  period: number;
  /** Where the playhead is. */
  time: number;
  recording: boolean;
  tracks: TrackState[];
  /** What can have keys, by layer. */
  keyable: Record<string, string[]>;
}

export interface SceneState {
  revision: number;
  name: string;
  dirty: boolean;
  mesh: MeshFacts | null;
  layers: Layer[];
  clip: ClipState | null;
  /** Vertices that have been given a name. */
  selections?: { name: string; count: number }[];
  history: { labels: Label[]; position: number };
}

export interface Label {
  key: string;
  subject: string;
}

export interface MeshFormat {
  name: string;
  suffixes: string[];
}

export interface Example {
  name: string;
  title: string;
  points: number;
}

export interface Catalogue {
  version: string;
  kinds: Kind[];
  meshes: MeshFormat[];
  readable: string[];
  transforms: MeshFormat[];
  quantities: string[];
  examples: Example[];
  /** Ways from key to key; those that are Bezier curves have handles. */
  easings: { name: string; handles: [number, number, number, number] | null }[];
  recent: string[];
  recoverable: { name: string; when: string }[];
  caps: { upload: number; chunk: number };
}
