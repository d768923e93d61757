// The faces around what the dashboard's pictures show, as they were scanned: each is fetched once.
import { patients } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { Surface } from "../scene/surface";

/** So many faces are kept: those of a wall and some more. */
const mostFaces = 24;

export class Faces {
  private readonly known = new Map<string, Surface | undefined>();

  /** Gives the face of a model; undefined where it has none (a plate) or it cannot be fetched. */
  async of(model: string): Promise<Surface | undefined> {
    if (model === "") return undefined;
    if (!this.known.has(model)) {
      const face = await this.fetch(model).catch(() => undefined);
      const [oldest] = this.known.keys();
      if (this.known.size >= mostFaces) this.drop(oldest);
      this.known.set(model, face);
    }
    return this.known.get(model);
  }

  private async fetch(name: string): Promise<Surface | undefined> {
    const { spec } = await patients.getModel({ name, readMask: { paths: ["spec"] } });
    if (spec?.geometry.case !== "scanRegion") return undefined;
    const mesh = (await collectMeshes(patients.downloadScanMesh({ name: spec.geometry.value.scan }))).get("scan");
    return mesh && new Surface(mesh);
  }

  private drop(model: string): void {
    this.known.get(model)?.dispose();
    this.known.delete(model);
  }

  dispose(): void {
    for (const model of [...this.known.keys()]) this.drop(model);
  }
}
