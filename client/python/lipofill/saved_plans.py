"""Plans that are kept with their patient."""

from __future__ import annotations

from typing import Iterator, Optional

from google.protobuf.field_mask_pb2 import FieldMask

from lipofill.channel import Channel
from lipofill.errors import InvalidArgumentError
from lipofill.plans import Plan
from lipofill.v1 import plan_service_pb2 as pb

_SIDES = {
    "": pb.PLAN_SIDE_UNSPECIFIED,
    "left": pb.LEFT_SIDE,
    "right": pb.RIGHT_SIDE,
    "both": pb.BOTH_SIDES,
}


class SavedPlans:
    """The plans that a daemon keeps: what a case is worked on with, by whoever opens it."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._stub = channel.plan_stub

    def save(
        self, patient: str, plan: Plan, *, scan: str = "", title: str = "", side: str = "", plan_id: str = ""
    ) -> pb.SavedPlan:
        """Keeps a plan, finished or not, as a new one of a patient. Files that it names stay out.

        Parameters
        ----------
        patient : str
            ``patients/{patient}``
        scan : str, optional
            ``patients/{patient}/scans/{scan}``, the face that it is for.
        title : str, optional
            A pseudonym: at most 63 characters of [a-z0-9-].
        side : {"", "left", "right", "both"}

        Raises
        ------
        InvalidArgumentError
            The plan names something of another patient, among others.
        NotFoundError
            The patient or the scan.
        """
        if side not in _SIDES:
            raise InvalidArgumentError(f'side is "{side}", must be one of left, right, both')
        saved = pb.SavedPlan(title=title, side=_SIDES[side], scan=scan, content=plan.message)
        saved.content.ClearField("scan")
        saved.content.ClearField("bone")
        if scan and saved.content.model.HasField("scan_region"):
            saved.content.model.scan_region.scan = scan
        request = pb.CreatePlanRequest(parent=patient, plan_id=plan_id, plan=saved)
        return self._channel.call(self._stub.CreatePlan, request)

    def get(self, name: str, *, revision: Optional[int] = None) -> pb.SavedPlan:
        """A plan as it is, or as it was at a revision."""
        if revision is not None:
            earlier = pb.GetPlanRevisionRequest(name=name, revision=revision)
            return self._channel.call(self._stub.GetPlanRevision, earlier)
        return self._channel.call(self._stub.GetPlan, pb.GetPlanRequest(name=name))

    def list(self, patient: str = "patients/-", *fields: str) -> Iterator[pb.SavedPlan]:
        """All of a patient, by default of every one, by name; with nothing but the fields named."""
        mask = FieldMask(paths=fields) if fields else None
        request = pb.ListPlansRequest(parent=patient, read_mask=mask)
        return self._channel.paged(self._stub.ListPlans, request, "plans")

    def update(self, plan: pb.SavedPlan, *fields: str) -> pb.SavedPlan:
        """Replaces the fields named, some of "title", "side", "scan", "target_scan" and "content";
        all of them without a name.

        Raises
        ------
        AbortedError
            Someone changed the plan since `plan.etag` was read; its violations name what was
            changed.
        """
        mask = FieldMask(paths=fields) if fields else None
        return self._channel.call(self._stub.UpdatePlan, pb.UpdatePlanRequest(plan=plan, update_mask=mask))

    def history(self, name: str) -> Iterator[pb.PlanRevision]:
        """What the plan was, the newest first, and what changed each time."""
        return self._channel.paged(self._stub.ListPlanRevisions, pb.ListPlanRevisionsRequest(parent=name), "revisions")

    def add_run(self, name: str, simulation: str, *, content_hash: str = "") -> pb.SavedPlan:
        """Notes that a simulation was made from the plan: from what has `content_hash`, or from the
        plan as it is.
        """
        request = pb.AddPlanRunRequest(name=name, simulation=simulation, content_hash=content_hash)
        return self._channel.call(self._stub.AddPlanRun, request)

    def delete(self, name: str) -> None:
        """Deletes the plan with its history; what was run from it stays."""
        self._channel.delete(self._stub.DeletePlan, pb.DeletePlanRequest(name=name))
