// A report of the plan to read, to print and to keep.
import { useEffect } from "preact/hooks";
import { busy } from "../activity";
import { forecast, forecastIsOld } from "../forecast/state";
import { canRun, modelIsCurrent, plan } from "../plan/state";
import { askWhetherOffered, makeReport, offered, pdfOf, report, settings } from "../report/make";
import { save } from "../run/exports";
import { planText } from "../target/state";
import { Section, SelectField } from "../widgets/fields";

function Made() {
  const { of, planText: text, name } = report.value!;
  const pdf = pdfOf(of);
  return (
    <>
      {text !== planText.value && <p class="warning">The plan was changed since this report was made.</p>}
      <div class="row wrap" role="group" aria-label="The report">
        <button
          type="button"
          class="button"
          onClick={() => save(`${name}-report.html`, new Blob([of.html], { type: "text/html" }))}
        >
          HTML
        </button>
        {pdf && (
          <button type="button" class="button" onClick={() => save(`${name}-report.pdf`, pdf)}>
            PDF
          </button>
        )}
        <button type="button" class="button" onClick={() => save(`${name}-report.csv`, of.csv)}>
          Figures
        </button>
      </div>
      {!pdf && <p class="hint">There is no PDF: print the HTML from the browser.</p>}
    </>
  );
}

export function ReportSection() {
  useEffect(() => void askWhetherOffered(), []);
  if (offered.value === undefined) return null;
  if (!offered.value)
    return (
      <Section title="Report">
        <p class="hint">
          Take the plan home, and <code>lipofill report {plan.value.name || "plan"}.json --out report</code> makes a
          page of all that is known of it.
        </p>
      </Section>
    );
  const hasForecast = forecast.value !== undefined && !forecastIsOld.value;
  const hasVolume = (plan.value.simulation?.injections ?? []).some(({ volumeMl }) => (volumeMl ?? 0) > 0);
  return (
    <Section title="Report">
      <div class="pair">
        <SelectField
          label="Language"
          value={settings.value.language}
          options={[
            { value: "en", label: "English" },
            { value: "de", label: "Deutsch" },
          ]}
          onChange={(language) => (settings.value = { ...settings.value, language })}
        />
        <SelectField
          label="Paper"
          value={settings.value.paper}
          options={[
            { value: "a4", label: "A4" },
            { value: "letter", label: "Letter" },
          ]}
          onChange={(paper) => (settings.value = { ...settings.value, paper })}
        />
      </div>
      <button
        type="button"
        class="button wide"
        disabled={busy.value !== undefined || !canRun.value || !modelIsCurrent.value || !hasVolume}
        onClick={() => void makeReport()}
      >
        Make the report
      </button>
      {!hasForecast && <p class="hint">Make the forecast first to have its intervals in the report.</p>}
      {report.value && <Made />}
    </Section>
  );
}
