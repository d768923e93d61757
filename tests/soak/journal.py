"""What happened, and what should not have: written by all clients, read at the end."""

from __future__ import annotations

import collections
import threading
from typing import Counter, Dict, List

import numpy as np

import lipofill
from lipofill.v1 import simulation_pb2


class Journal:
    """Counts, state hashes by plan, and complaints. Thread-safe."""

    MOST_COMPLAINTS = 50

    def __init__(self, ledger_relative_error: float) -> None:
        self._lock = threading.Lock()
        self._bound = ledger_relative_error
        self.counts: Counter[str] = collections.Counter()
        self.hashes: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
        self.complaints: List[str] = []
        self.worst_ledger = 0.0

    def count(self, what: str, times: int = 1) -> None:
        with self._lock:
            self.counts[what] += times

    def complain(self, text: str) -> None:
        """Something that must not be; the soak fails."""
        with self._lock:
            self.counts["complaints"] += 1
            if len(self.complaints) < self.MOST_COMPLAINTS:
                self.complaints.append(text)

    def note_hash(self, plan: str, state_hash: str) -> None:
        """The result of a plan that nobody touched: always the same."""
        with self._lock:
            self.hashes[plan][state_hash] += 1
            different = len(self.hashes[plan]) > 1
        if different:
            self.complain(f"plan {plan} came to {len(self.hashes[plan])} different states")

    def check_ledger(
        self,
        name: str,
        ended: simulation_pb2.Simulation,
        series: lipofill.Series,
        planned_ml: float,
        more_ml: float = 0.0,
    ) -> None:
        """Injected fat is film volume less what there was before, in every row and in the end; and
        all of it was injected.

        What was added while it ran (`more_ml`) may come too late for the end time: then at least
        what was planned is there.
        """
        injected, film = series["injected_ml"], series["film_volume_ml"]
        initial = film[0] - injected[0]
        errors = [
            ended.summary.film_volume_relative_error,
            np.abs(film - injected - initial).max() / max(injected.max(), initial),
        ]
        if ended.state in (simulation_pb2.Simulation.SETTLED, simulation_pb2.Simulation.FINISHED):
            injected_ml = ended.summary.injected_ml
            errors.append(max(planned_ml - injected_ml, injected_ml - planned_ml - more_ml, 0.0) / planned_ml)
        steps = series["step"].astype(np.int64)
        if len(steps) != ended.summary.steps or (np.diff(steps) != 1).any():
            self.complain(f"{name}: {len(steps)} rows of {ended.summary.steps} steps, or not in order")
        with self._lock:
            self.worst_ledger = max(self.worst_ledger, *map(float, errors))
        if not max(errors) <= self._bound:
            self.complain(f"{name}: the ledger is off by {max(errors):.3g}, the bound is {self._bound:g}")
