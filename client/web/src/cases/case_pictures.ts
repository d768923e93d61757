// Small pictures of faces, one after the other, on one canvas beside the page. They stay in memory:
// a picture of a face tells who somebody is, and is not for a disk.
import { patients } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { Surface } from "../scene/surface";
import { Viewport } from "../scene/viewport";
import { viewOf } from "../scene/outside_view";

const [width, height] = [192, 192];
const pauseMs = 100;

export class CasePictures {
  private readonly holder = document.createElement("div");
  private readonly viewport: Viewport;
  private readonly leave = new AbortController();
  private readonly urls = new Map<string, string>();
  private wanted: string[] = [];

  constructor(private readonly done: (scan: string, url: string) => void) {
    const [left, top] = ["-2000px", "0"];
    Object.assign(this.holder.style, { position: "fixed", left, top, width: `${width}px`, height: `${height}px` });
    document.body.append(this.holder);
    this.viewport = new Viewport(this.holder);
    void this.turn();
  }

  /** @param scans  those that are seen, the first first */
  want(scans: string[]): void {
    this.wanted = scans.filter((scan) => scan !== "");
  }

  private async turn(): Promise<void> {
    while (!this.leave.signal.aborted) {
      const due = this.wanted.find((scan) => !this.urls.has(scan));
      // What cannot be drawn is not tried again.
      if (due) await this.draw(due).catch(() => this.urls.set(due, ""));
      await new Promise((resolve) => setTimeout(resolve, pauseMs));
    }
  }

  private async draw(scan: string): Promise<void> {
    const download = patients.downloadScanMesh({ name: scan }, { signal: this.leave.signal });
    const mesh = (await collectMeshes(download)).get("scan");
    if (mesh === undefined) throw new Error(`${scan} came without its surface`);
    const surface = new Surface(mesh);
    this.viewport.add(surface.actor);
    const { focus, direction, up, halfHeight } = viewOf(surface);
    this.viewport.lookAt(focus, direction, up, halfHeight);
    const url = URL.createObjectURL(await this.viewport.capture());
    this.viewport.remove(surface.actor);
    surface.dispose();
    this.urls.set(scan, url);
    this.done(scan, url);
  }

  dispose(): void {
    this.leave.abort();
    this.urls.forEach((url) => url !== "" && URL.revokeObjectURL(url));
    this.viewport.dispose();
    this.holder.remove();
  }
}
