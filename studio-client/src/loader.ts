// The mesh as the server sends it: whole, or the points that have moved; edges and textures are fetched when needed.

import { Vector3 } from "three";
import { t } from "./core/strings";
import type { Studio } from "./studio";
import type { DrawnMesh } from "./view/mesh_view";

export function loadMeshes(studio: Studio): void {
  let shown: number | null = null;
  let asked: number | null = null;

  const edges = async (): Promise<void> => {
    const { mesh, settings, scene } = studio;
    if (!settings.now.wireframe || mesh.hasEdges || !scene?.mesh || asked === scene.mesh.id) return;
    asked = scene.mesh.id;
    const answer = await studio.ask("mesh.edges");
    if (!answer || studio.scene?.mesh?.id !== asked) return;
    mesh.setEdges(answer.arrays["edges"] as Uint32Array);
    mesh.apply(settings.now, studio.palette);
  };

  const textures = async (): Promise<void> => {
    for (const id of studio.mesh.materials.wanted) {
      const answer = await studio.ask("mesh.texture", { id });
      if (!answer) continue;
      try {
        await studio.mesh.materials.setTexture(id, answer.arrays["file"] as Uint8Array);
      } catch (error) {
        studio.tell(error);
      }
    }
  };

  studio.session.on("mesh", ({ head, arrays }) => {
    const id = head["id"] as number;
    studio.mesh.load({
      count: head["count"] as number,
      positions: arrays["positions"] as Float32Array,
      normals: arrays["normals"] as Int8Array,
      triangles: arrays["triangles"] as Uint32Array,
      twins: arrays["twins"] as Uint32Array,
      uvs: (arrays["uvs"] as Float32Array | undefined) ?? null,
      parts: head["parts"] as DrawnMesh["parts"],
      materials: head["materials"] as DrawnMesh["materials"],
    });
    asked = null;
    studio.mesh.apply(studio.settings.now, studio.palette);
    studio.placeGround();
    if (id !== shown) studio.frame(undefined, shown === null ? firstLook(studio.settings.now.up) : undefined);
    shown = id;
    studio.meshLoaded.set(studio.meshLoaded.value + 1);
    if (!(arrays["triangles"] as Uint32Array).length) studio.toasts.info(t("noFaces"));
    void edges();
    void textures();
  });

  studio.session.on("points", ({ head, arrays }) => {
    studio.mesh.move(head["all"] ? null : arrays["index"]!, arrays["positions"]!, arrays["normals"]!);
    studio.pointsMoved.set(studio.pointsMoved.value + 1);
  });

  studio.session.scene.onChange((scene) => {
    if (!scene?.mesh && shown !== null) {
      studio.mesh.clear();
      shown = null;
    }
    studio.viewport.ground.object.visible = studio.settings.now.ground && (scene?.mesh ?? null) !== null;
    studio.viewport.request();
  });
  studio.settings.all.onChange(() => void edges());
}

const firstLook = (up: "y" | "z"): Vector3 => (up === "z" ? new Vector3(0.62, -1, 0.5) : new Vector3(0.62, 0.5, 1));
