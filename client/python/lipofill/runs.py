"""A plan carried out: from scan to result."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Optional, Type

from lipofill.channel import Channel
from lipofill.errors import NotFoundError, PermissionDeniedError
from lipofill.models import Models
from lipofill.patients import Patients
from lipofill.plans import Plan, unit_name
from lipofill.progress import ProgressCallback
from lipofill.scans import Scans
from lipofill.simulation import Simulation
from lipofill.simulations import Simulations
from lipofill.v1 import model_pb2, simulation_pb2


@dataclass(frozen=True)
class Collections:
    """Where a run makes what it needs, and takes it away again."""

    patients: Patients
    scans: Scans
    models: Models
    simulations: Simulations


def display_name_of(plan_name: str) -> str:
    """A plan's name as the daemon takes it for dashboards: at most 63 characters of [a-z0-9-]."""
    return re.sub(r"[^a-z0-9]", "-", plan_name.lower()[:63])


class Run(Simulation):
    """The simulation of a plan, with the patient and the model that were made for it.

        with connection.run(plan, progress=lipofill.print_progress) as run:
            result = run.wait()

    Entering starts it, leaving stops it unless it has ended, and deletes what was made for it
    unless `keep`.

    Attributes
    ----------
    plan : Plan
    patient : str
    model : lipofill.v1.Model
    """

    def __init__(
        self,
        channel: Channel,
        collections: Collections,
        name: str,
        plan: Plan,
        patient: str,
        model: model_pb2.Model,
        keep: bool,
        made_patient: bool,
    ) -> None:
        super().__init__(channel, name)
        self._collections = collections
        self.plan = plan
        self.patient = patient
        self.model = model
        self._keep = keep
        self._made_patient = made_patient

    @classmethod
    def prepare(
        cls,
        channel: Channel,
        collections: Collections,
        plan: Plan,
        patient: str,
        keep: bool,
        progress: Optional[ProgressCallback],
    ) -> Run:
        """See Connection.run. What was made is taken away again where a step fails."""
        spec = plan.model_with_landmarks()
        made_patient = not patient
        if made_patient:
            patient = collections.patients.create().name
        try:
            _upload(collections.scans, plan, patient, spec, progress)
            model = collections.models.build(patient, spec, progress=progress)
            simulation = simulation_pb2.SimulationSpec()
            simulation.CopyFrom(plan.simulation)
            simulation.model = model.name
            made = collections.simulations.create(simulation, display_name=display_name_of(plan.message.name))
        except BaseException:
            if made_patient:
                _delete_patient(collections.patients, patient)
            raise
        return cls(channel, collections, made.name, plan, patient, model, keep, made_patient)

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        super().__exit__(kind, error, trace)
        if not self._keep:
            self.discard()

    def discard(self) -> None:
        """Deletes the simulation, its model and, where it was made for the run and the caller may,
        the patient with the scans.
        """
        with suppress(NotFoundError):
            self.delete()
        with suppress(NotFoundError):
            self._collections.models.delete(self.model.name)
        if self._made_patient:
            _delete_patient(self._collections.patients, self.patient)


def _delete_patient(patients: Patients, patient: str) -> None:
    """A planner may make patients, but needs an admin to delete them: then it stays."""
    with suppress(PermissionDeniedError):
        patients.delete(patient, force=True)


def _upload(
    scans: Scans, plan: Plan, patient: str, spec: model_pb2.ModelSpec, progress: Optional[ProgressCallback]
) -> None:
    """Sends the files that the plan names and puts their names into the model."""
    scan, bone = plan.scan_path(), plan.bone_path()
    if scan is not None:
        unit = unit_name(plan.message.scan.unit)
        spec.scan_region.scan = scans.upload(patient, scan, unit=unit, progress=progress).name
    if bone is not None:
        unit = unit_name(plan.message.bone.unit)
        spec.scan_region.bone_scan = scans.upload(patient, bone, unit=unit, progress=progress).name
