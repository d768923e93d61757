// Fat that a run which has settled may have more of, or less: looked at first, then injected.
import { busy } from "../activity";
import { readable } from "../plan/anatomy";
import { addToRun, chooseZone, dragAdded, inZone, releaseAdded, wanted, zone, zoneNames } from "../shape/added_fat";
import { NumberField, Section, SelectField } from "../widgets/fields";
import { VolumeSlider } from "../widgets/volume_slider";

const most = 5;

export function AddedFat() {
  const { volumeMl, rateMlPerS } = wanted.value;
  const least = -Math.min(most, Math.floor(inZone.value * 20) / 20);
  return (
    <Section title="Add or remove fat">
      <SelectField
        label="Zone"
        value={zone.value}
        options={zoneNames.value.map((name) => ({ value: name, label: readable(name) }))}
        field="injection.zone"
        onChange={chooseZone}
      />
      <div class="pair">
        <NumberField
          label="Volume"
          unit="mL"
          step={0.05}
          value={volumeMl}
          field="injection.volume_ml"
          onChange={(value) => releaseAdded(value ?? 0)}
        />
        <NumberField
          label="Rate"
          unit="mL/s"
          step={0.1}
          value={rateMlPerS}
          field="injection.rate_ml_per_s"
          onChange={(value) => (wanted.value = { ...wanted.value, rateMlPerS: value })}
        />
      </div>
      <VolumeSlider
        label={`Volume added to ${readable(zone.value)}`}
        value={volumeMl}
        min={least}
        max={most}
        onDrag={dragAdded}
        onRelease={releaseAdded}
      />
      <p class="quiet">A volume below 0 takes fat out. The run goes on until it has settled again.</p>
      <button
        type="button"
        class="button"
        disabled={volumeMl === 0 || busy.value !== undefined}
        onClick={() => void addToRun()}
      >
        {volumeMl < 0 ? "Remove from the run" : "Add to the run"}
      </button>
    </Section>
  );
}
