// How the volumes of the plan are laid by hand: entries, tunnels, mL a pass.
import { signal } from "@preact/signals";
import { busy } from "../activity";
import { readable } from "../plan/anatomy";
import { modelIsCurrent, plan } from "../plan/state";
import { save } from "../run/exports";
import { cssOf, entryColours } from "../scene/colour_maps";
import { makeDelivery, settings, takeAsGiven, tunnelsOf, writeDelivery } from "../target/delivery";
import { delivery, deliveryIsOld } from "../target/state";
import { CheckField, Complaint, NumberField, Section } from "../widgets/fields";

/** The entry whose tunnels are listed. */
const open = signal(0);

function Settings() {
  const { maxPassMl, tunnelSpacingMm, compare } = settings.value;
  return (
    <>
      <div class="pair">
        <NumberField
          label="A pass, at most"
          unit="mL"
          step={0.01}
          min={0}
          max={0.1}
          placeholder="0.1"
          value={maxPassMl}
          field="delivery.max_pass_ml"
          onChange={(value) => (settings.value = { ...settings.value, maxPassMl: value })}
        />
        <NumberField
          label="Tunnels apart"
          unit="mm"
          min={2}
          max={20}
          placeholder="5"
          value={tunnelSpacingMm}
          field="delivery.tunnel_spacing_mm"
          onChange={(value) => (settings.value = { ...settings.value, tunnelSpacingMm: value })}
        />
      </div>
      <CheckField
        label="Compare the shape with the plan's"
        value={compare}
        onChange={(value) => (settings.value = { ...settings.value, compare: value })}
      />
    </>
  );
}

function Entry({ index }: { index: number }) {
  const { list } = delivery.value!;
  const entry = list.entries[index];
  const tunnels = tunnelsOf(list).filter((tunnel) => tunnel.entry === index);
  const isOpen = open.value === index;
  return (
    <li class="item">
      <button
        type="button"
        class="entry grow"
        aria-expanded={isOpen}
        onClick={() => (open.value = isOpen ? -1 : index)}
      >
        <i class="swatch" style={{ background: cssOf(entryColours[index % entryColours.length]) }} aria-hidden="true" />
        <span class="grow">
          <b>
            {index + 1}. {readable(entry.zone)}
          </b>{" "}
          <span class="quiet">under {readable(entry.belowLayer).toLowerCase()}</span>
        </span>
        <span>
          {entry.volumeMl.toFixed(2)} mL in {entry.passes} passes
        </span>
      </button>
      {isOpen && (
        <table class="figures-table">
          <thead>
            <tr>
              <th scope="col">Tunnel</th>
              <th scope="col">passes</th>
              <th scope="col">mL a pass</th>
              <th scope="col">mL</th>
            </tr>
          </thead>
          <tbody>
            {tunnels.map(({ tunnel, passes, volumeMl }) => (
              <tr key={tunnel}>
                <th scope="row">{tunnel + 1}</th>
                <td>{passes.length}</td>
                <td>{(volumeMl / passes.length).toFixed(3)}</td>
                <td>{volumeMl.toFixed(2)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </li>
  );
}

function List() {
  const { list } = delivery.value!;
  return (
    <>
      <ol class="items" aria-label="Entries, in the order in which they are made">
        {list.entries.map((_, index) => (
          <Entry key={index} index={index} />
        ))}
      </ol>
      {list.difference && (
        <p class="quiet">
          Laid so, the skin comes to within {list.difference.p95Mm.toFixed(2)} mm of the plan's shape in 95 of 100
          places, {list.difference.maxMm.toFixed(2)} mm at most.
        </p>
      )}
      {list.remarks.map((text) => (
        <p class="hint" key={text}>
          {text}
        </p>
      ))}
      <div class="row wrap">
        <button
          type="button"
          class="button"
          onClick={() => save(`${plan.value.name || "plan"}-injections.csv`, writeDelivery(list))}
        >
          Save the list
        </button>
        <button type="button" class="button" onClick={takeAsGiven}>
          Plan it pass by pass
        </button>
      </div>
    </>
  );
}

export function DeliverySection() {
  const hasVolume = (plan.value.simulation?.injections ?? []).some(({ volumeMl }) => (volumeMl ?? 0) > 0);
  return (
    <Section title="Injection list">
      <Settings />
      <button
        type="button"
        class="button wide"
        disabled={busy.value !== undefined || !modelIsCurrent.value || !hasVolume}
        onClick={() => void makeDelivery()}
      >
        Make the injection list
      </button>
      <Complaint field="delivery" />
      {deliveryIsOld.value && <p class="warning">The plan was changed since this list was made.</p>}
      {delivery.value && <List />}
    </Section>
  );
}
