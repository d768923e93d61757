// A volume under the hand: told while it is dragged, and when it is let go.
import { useRef } from "preact/hooks";

interface Props {
  /** what it is the volume of, for those who do not see where it stands */
  label: string;
  value: number;
  min: number;
  max: number;
  onDrag: (volumeMl: number) => void;
  onRelease: (volumeMl: number) => void;
}

export function VolumeSlider({ label, value, min, max, onDrag, onRelease }: Props) {
  const held = useRef(false);
  const release = (input: HTMLInputElement): void => {
    if (!held.current) return;
    held.current = false;
    onRelease(Number(input.value));
  };
  return (
    <input
      type="range"
      class="volume-slider"
      aria-label={label}
      aria-valuetext={`${value.toFixed(2)} mL`}
      min={min}
      max={max}
      step={0.05}
      value={value}
      onInput={(event) => {
        held.current = true;
        onDrag(Number(event.currentTarget.value));
      }}
      onChange={(event) => release(event.currentTarget)}
      // A thumb that is let go where it was taken up has not changed.
      onPointerUp={(event) => release(event.currentTarget)}
      onPointerCancel={(event) => release(event.currentTarget)}
      onBlur={(event) => release(event.currentTarget)}
    />
  );
}
