// The frame around planner and dashboard.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { setToken, token } from "./api/client";
import { CaseList } from "./cases/case_list";
import { Dashboard } from "./dashboard/dashboard";
import { writeAddress } from "./case/address";
import { keeping, saved } from "./case/saved_plan";
import { address, bindAddress, page } from "./case/restore";
import { KeysHelp, showKeys } from "./keys_help";
import { redoChange, undoChange } from "./keyboard";
import { canRedo, canUndo, patientName, plan } from "./plan/state";
import { recorded } from "./run/state";
import { notice } from "./activity";
import { presenting } from "./stage/stage_state";
import { Planner } from "./planner";

const asking = signal(false);

function Credentials() {
  if (!asking.value) return null;
  return (
    <dialog open class="credentials" aria-label="Credentials">
      <form
        method="dialog"
        onSubmit={(event) => {
          event.preventDefault();
          setToken(new FormData(event.currentTarget).get("token") as string);
          [asking.value, notice.value] = [false, ""];
        }}
      >
        <label for="token">Bearer token</label>
        <input id="token" name="token" type="password" autocomplete="off" defaultValue={token.value} />
        <div class="row">
          <button type="submit" class="button primary">
            Use
          </button>
          <button type="button" class="button" onClick={() => (asking.value = false)}>
            Cancel
          </button>
        </div>
        <p class="quiet">Kept until this tab closes.</p>
      </form>
    </dialog>
  );
}

/** Whose plan it is; of a folder of results that is not known. */
function CaseName() {
  const name = recorded.value !== "" ? `results in ${recorded.value}` : plan.value.name;
  return (
    <span class="plan-name">
      {patientName.value !== "" && recorded.value === "" && <b>{patientName.value}</b>} {name}
    </span>
  );
}

const words = {
  kept: "",
  saving: "Saving…",
  waiting: "Not saved yet: the daemon cannot be reached",
  refused: "Not saved",
};

/** Whether what is on the page is on the daemon. */
function Keeping() {
  const text = keeping.value === "kept" && saved.value ? "Saved" : words[keeping.value];
  return (
    <span class={`keeping ${keeping.value}`} role="status">
      {text}
    </span>
  );
}

function Changes() {
  return (
    <span class="changes">
      <button type="button" class="button small" disabled={!canUndo.value} title="Ctrl+Z" onClick={undoChange}>
        Undo
      </button>
      <button type="button" class="button small" disabled={!canRedo.value} title="Ctrl+Y" onClick={redoChange}>
        Redo
      </button>
    </span>
  );
}

export function App() {
  useEffect(bindAddress, []);
  const onPlan = page.value === "plan";
  return (
    <>
      <header class="top" hidden={presenting.value && onPlan}>
        <span class="brand">
          <img src="./icon.svg" alt="" width="26" height="26" />
          Lipofill
        </span>
        {onPlan && <CaseName />}
        <nav aria-label="Pages">
          <a href={writeAddress({ ...address.value, page: "plan" })} aria-current={onPlan ? "page" : undefined}>
            Planner
          </a>
          <a href="#cases" aria-current={page.value === "cases" ? "page" : undefined}>
            Cases
          </a>
          <a href="#dashboard" aria-current={page.value === "dashboard" ? "page" : undefined}>
            Dashboard
          </a>
        </nav>
        {onPlan && <Changes />}
        {onPlan && <Keeping />}
        {notice.value && (
          <span class="notice" role="alert">
            {notice.value}
          </span>
        )}
        <button type="button" class="link" onClick={() => (asking.value = !asking.value)}>
          Credentials
        </button>
        <button
          type="button"
          class="link keys-link"
          aria-expanded={showKeys.value}
          onClick={() => (showKeys.value = !showKeys.value)}
        >
          Keys
        </button>
        <span class="disclaimer">Research and planning aid, not a medical device</span>
      </header>
      <Credentials />
      <KeysHelp />
      {onPlan && <Planner />}
      {page.value === "cases" && <CaseList />}
      {page.value === "dashboard" && <Dashboard />}
    </>
  );
}
