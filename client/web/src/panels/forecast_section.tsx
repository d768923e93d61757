// The forecast: what is asked, what matters most, and what to inject so that enough is left.
import { Retention_Preset } from "@wire/forecast_service_pb";
import { busy } from "../activity";
import { monthWords } from "../forecast/numbers";
import { makeForecast } from "../forecast/make";
import { asked, forecast, forecastIsOld, forecastView } from "../forecast/state";
import { readable } from "../plan/anatomy";
import { plainWords } from "../plan/field_words";
import { canRun, modelIsCurrent, plan } from "../plan/state";
import { CheckField, Complaint, Section, SelectField } from "../widgets/fields";

const howMany = [
  { value: 100, label: "100, quick" },
  { value: 500, label: "500" },
  { value: 1000, label: "1,000, slow" },
];

const retentions = [
  { value: Retention_Preset.POOLED, label: "Pooled, 47 % after a year" },
  { value: Retention_Preset.ACQUIRED_ATROPHY, label: "Acquired atrophy, 43 %" },
  { value: Retention_Preset.MIXED_INDICATIONS, label: "Mixed indications, 64 %" },
  { value: Retention_Preset.COTTON_PAD, label: "Fat from a cotton pad, 41 %" },
  { value: Retention_Preset.CENTRIFUGE, label: "Fat from a centrifuge, 34 %" },
];

/** The table has what is left of each zone, and what to inject so that its planned volume is. */
function Zones() {
  const { zones, times } = forecast.value!;
  const last = times.at(-1);
  if (zones.length === 0 || last === undefined) return null;
  return (
    <table class="figures-table">
      <caption class="sr-only">What is left {monthWords(last.month)}, in mL</caption>
      <thead>
        <tr>
          <th scope="col">mL {monthWords(last.month)}</th>
          <th scope="col">left</th>
          <th scope="col">inject</th>
        </tr>
      </thead>
      <tbody>
        {zones.map((one) => (
          <tr key={one.zone}>
            <th scope="row">
              {readable(one.zone)} <span class="quiet">{one.plannedMl.toFixed(1)} planned</span>
            </th>
            <td data-left={one.zone}>
              {one.remainingMl.toFixed(1)}
              <br />
              <span class="quiet">
                {one.remainingP05Ml.toFixed(1)}–{one.remainingP95Ml.toFixed(1)}
              </span>
            </td>
            <td data-inject={one.zone}>
              {one.injectMl.toFixed(1)}
              <br />
              <span class="quiet">
                {one.injectLowMl.toFixed(1)}–{one.injectHighMl.toFixed(1)}
              </span>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Found() {
  const { members, failedMembers, failures, causes, remarks, retention, sessions } = forecast.value!;
  return (
    <>
      {forecastIsOld.value ? (
        <p class="warning">The plan was changed since: this forecast is of the plan before.</p>
      ) : (
        <CheckField
          label="Show it on the face, by months"
          value={forecastView.value !== "off"}
          onChange={(value) => (forecastView.value = value ? "mean" : "off")}
        />
      )}
      <Zones />
      <p class="quiet">
        To inject: so that half of the cases keep the planned volume. From {members - failedMembers} of {members} cases.
        {sessions.length > 1 &&
          ` The pressure asks for ${sessions.length} sessions: ${sessions
            .map(
              ({ month, injectMl }) =>
                `${injectMl.reduce((sum, ml) => sum + ml, 0).toFixed(1)} mL ${month === 0 ? "at first" : monthWords(month)}`,
            )
            .join(", ")}.`}
      </p>
      {causes.length > 0 && (
        <ul class="plain-list" aria-label="What matters most">
          {causes.map((cause) => (
            <li key={cause}>{plainWords(cause, plan.value).replaceAll("+-", "±")}</li>
          ))}
        </ul>
      )}
      {failures.map(({ reason, members: count }) => (
        <p class="hint" key={reason}>
          {count} cases did not settle: {plainWords(reason, plan.value)}
        </p>
      ))}
      {[...remarks, ...(retention?.remarks ?? [])].map((text) => (
        <p class="hint" key={text}>
          {plainWords(text, plan.value)}
        </p>
      ))}
    </>
  );
}

export function ForecastSection() {
  const hasVolume = (plan.value.simulation?.injections ?? []).some(({ volumeMl }) => (volumeMl ?? 0) > 0);
  return (
    <Section title="Forecast">
      <p class="hint">How well the result is known, and what is left of it after months.</p>
      <SelectField
        label="What is left of the fat"
        value={asked.value.retention}
        options={retentions}
        field="forecast.retention"
        onChange={(value) => (asked.value = { ...asked.value, retention: Number(value) })}
      />
      <SelectField
        label="Cases of tissue"
        value={asked.value.members}
        options={howMany}
        field="forecast.members"
        onChange={(value) => (asked.value = { ...asked.value, members: Number(value) })}
      />
      <button
        type="button"
        class="button wide"
        disabled={busy.value !== undefined || !modelIsCurrent.value || !canRun.value || !hasVolume}
        onClick={() => void makeForecast()}
      >
        Make the forecast
      </button>
      {!modelIsCurrent.value && <p class="hint">The model of the tissue has to be built first.</p>}
      <Complaint field="forecast" />
      {forecast.value && <Found />}
    </Section>
  );
}
