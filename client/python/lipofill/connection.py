"""A daemon to talk to."""

from __future__ import annotations

from typing import Optional

from lipofill.channel import DEFAULT_TIMEOUT_S, Channel
from lipofill.credentials import Credentials
from lipofill.forecasts import Forecasts
from lipofill.models import Models
from lipofill.operations import Operations
from lipofill.patients import Patients
from lipofill.plans import Plan
from lipofill.progress import ProgressCallback
from lipofill.proposals import Proposals
from lipofill.reports import Reports
from lipofill.retries import RetryPolicy
from lipofill.runs import Collections, Run
from lipofill.saved_plans import SavedPlans
from lipofill.scans import Scans
from lipofill.simulations import Simulations
from lipofill.targets import Targets


class Connection(Channel):
    """A connection to a daemon. A context manager; thread-safe.

        with lipofill.Connection() as connection:
            with connection.run(lipofill.Plan.load("jaw_angle.json")) as run:
                print(run.wait().summary.skin_max_displacement_mm)

    Parameters
    ----------
    server : str, optional
        ``"host:port"`` or ``"unix:/path"``; default: the environment's LIPOFILL_SERVER, else
        127.0.0.1:50061.
    credentials : Credentials, optional
        Default: from the environment, see Credentials.from_environment.
    retry : RetryPolicy, optional
        How long calls are made again where that is safe: reads, deletions, and creates and
        commands, which bear a request_id.
    timeout_s : float
        Of one attempt at a call.

    Attributes
    ----------
    patients, scans, models, plans, targets, proposals, forecasts, simulations, operations
        What the daemon holds.
    reports
        Pages of all that is known of a plan, see Reports.
    patient_stub, plan_stub, simulation_stub, frame_stub, operation_stub, planning_stub,
    forecast_stub
        The generated stubs, for ``call``.
    """

    def __init__(
        self,
        server: Optional[str] = None,
        *,
        credentials: Optional[Credentials] = None,
        retry: RetryPolicy = RetryPolicy(),
        timeout_s: float = DEFAULT_TIMEOUT_S,
    ) -> None:
        super().__init__(server, credentials=credentials, retry=retry, timeout_s=timeout_s)
        self.patients = Patients(self)
        self.scans = Scans(self)
        self.operations = Operations(self)
        self.models = Models(self, self.operations)
        self.plans = SavedPlans(self)
        self.targets = Targets(self, self.operations)
        self.proposals = Proposals(self, self.operations)
        self.forecasts = Forecasts(self, self.operations)
        self.reports = Reports(self)
        self.simulations = Simulations(self)

    def run(
        self,
        plan: Plan,
        *,
        patient: str = "",
        keep: bool = False,
        progress: Optional[ProgressCallback] = None,
    ) -> Run:
        """Brings a plan to the daemon: uploads its scans, builds its model, creates its simulation.
        Entering the run starts it.

        Parameters
        ----------
        plan : Plan
        patient : str
            A patient the daemon has, ``patients/{patient}``; default: a new one.
        keep : bool
            Whether what was made stays on the daemon once the run is left.
        progress : callable, optional
            Told what is being done, see Progress.
        """
        collections = Collections(self.patients, self.scans, self.models, self.simulations)
        return Run.prepare(self, collections, plan, patient, keep, progress)
