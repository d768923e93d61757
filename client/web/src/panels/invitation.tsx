// What an empty page offers: a scan that is dropped, the sample, a run.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { busy } from "../activity";
import { uploadFace } from "../case/face";
import { openSample } from "../case/open";
import { step } from "../stage/stage_state";
import { FileButton } from "../widgets/fields";
import { unit } from "./case_section";

const over = signal(false);

const take = async (file: File | undefined): Promise<void> => {
  if (file && !busy.value) await uploadFace(file.name, await file.arrayBuffer(), unit.value);
};

/** Files that miss the box are not opened by the browser in place of the page. */
function useDrop(): void {
  useEffect(() => {
    const drag = (event: DragEvent): void => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      over.value = event.type === "dragover";
      if (event.type === "drop") void take(event.dataTransfer.files[0]);
    };
    const kinds = ["dragover", "dragleave", "drop"] as const;
    kinds.forEach((kind) => window.addEventListener(kind, drag));
    return () => kinds.forEach((kind) => window.removeEventListener(kind, drag));
  }, []);
}

export function Invitation() {
  useDrop();
  return (
    <div class={`invitation ${over.value ? "over" : ""}`}>
      <h1>Plan a fat graft</h1>
      <p>Drop a scan of the face here (OBJ, PLY or STL), or begin with one of these.</p>
      <div class="row wrap">
        <FileButton label="Choose a scan…" accept=".obj,.ply,.stl" onFiles={([file]) => take(file)} />
        <button
          type="button"
          class="button primary"
          disabled={busy.value !== undefined}
          onClick={() => void openSample()}
        >
          Open the sample
        </button>
        <button type="button" class="button" onClick={() => (step.value = "run")}>
          Open a run…
        </button>
      </div>
    </div>
  );
}
