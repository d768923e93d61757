// Which keys there are, and whether single ones do something (WCAG 2.1.4: who speaks to the machine
// or hits keys by mistake turns them off).
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { keepSingleKeys, singleKeys } from "./keyboard";
import { CheckField } from "./widgets/fields";

export const showKeys = signal(false);

const keys: [string[], string][] = [
  [["1", "to", "5"], "Goes to that step"],
  [["Ctrl+Z", "Ctrl+Y"], "Takes the last change back, does it again"],
  [["arrows", "+", "-"], "On the picture: turn the face, come nearer; with a tool they lead it"],
  [["Enter"], "On the picture: uses the tool"],
  [["space"], "Runs or pauses"],
  [["←", "→", "End"], "Goes through time, to the newest picture"],
  [["d", "p", "t"], "Colours by displacement, pressure, thickness"],
  [["c"], "After, side by side, slider"],
  [["[", "]"], "A smaller brush, a larger one"],
  [["Esc"], "Leaves the tool, or the view without forms"],
];

const isWord = (key: string): boolean => key === "to" || key === "arrows";

export function KeysHelp() {
  const dialog = useRef<HTMLDialogElement>(null);
  const isOpen = showKeys.value;
  // What had the focus has it again when it is closed.
  useEffect(() => void (isOpen && dialog.current?.showModal()), [isOpen]);
  if (!isOpen) return null;
  return (
    <dialog ref={dialog} class="keys-help" aria-label="Keys" onClose={() => (showKeys.value = false)}>
      <CheckField label="Letters and digits work by themselves" value={singleKeys.value} onChange={keepSingleKeys} />
      <table>
        <tbody>
          {keys.map(([names, what]) => (
            <tr key={what}>
              <th scope="row">{names.map((name) => (isWord(name) ? ` ${name} ` : <kbd key={name}>{name}</kbd>))}</th>
              <td>{what}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <button type="button" class="button" onClick={() => dialog.current?.close()}>
        Close
      </button>
    </dialog>
  );
}
