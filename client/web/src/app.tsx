// The frame around planner and dashboard.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { setToken, token } from "./api/client";
import { Dashboard } from "./dashboard/dashboard";
import { openSample } from "./plan/actions";
import { plan } from "./plan/state";
import { notice } from "./activity";
import { Planner } from "./planner";

const page = signal(location.hash);
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

export function App() {
  useEffect(() => {
    const turn = (): void => void (page.value = location.hash);
    window.addEventListener("hashchange", turn);
    if (location.hash === "#sample") {
      history.replaceState(null, "", "#plan");
      turn();
      void openSample();
    }
    return () => window.removeEventListener("hashchange", turn);
  }, []);
  const onDashboard = page.value === "#dashboard";
  return (
    <>
      <header class="top">
        <span class="brand">
          <img src="./icon.svg" alt="" width="26" height="26" />
          Lipofill
        </span>
        {!onDashboard && <span class="plan-name">{plan.value.name}</span>}
        <nav aria-label="Pages">
          <a href="#plan" aria-current={onDashboard ? undefined : "page"}>
            Planner
          </a>
          <a href="#dashboard" aria-current={onDashboard ? "page" : undefined}>
            Dashboard
          </a>
        </nav>
        {notice.value && (
          <span class="notice" role="alert">
            {notice.value}
          </span>
        )}
        <button type="button" class="link" onClick={() => (asking.value = !asking.value)}>
          Credentials
        </button>
        <span class="disclaimer">Research and planning aid, not a medical device</span>
      </header>
      <Credentials />
      {onDashboard ? <Dashboard /> : <Planner />}
    </>
  );
}
