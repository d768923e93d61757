"""Plans that are proposed for a target, and the lists by which they are delivered."""

from __future__ import annotations

from typing import Optional

from lipofill.channel import Channel
from lipofill.operations import Operations
from lipofill.progress import ProgressCallback
from lipofill.retries import with_request_id
from lipofill.v1 import planning_service_pb2 as pb
from lipofill.v1 import simulation_pb2


class Proposals:
    """Proposes plans and lists how they are delivered."""

    def __init__(self, channel: Channel, operations: Operations) -> None:
        self._channel = channel
        self._operations = operations
        self._stub = channel.planning_stub

    def propose(
        self, patient: str, spec: pb.ProposalSpec, *, progress: Optional[ProgressCallback] = None
    ) -> pb.Proposal:
        """Proposes a plan and waits for it. An interruption (Ctrl-C, an exception of `progress`)
        cancels the work too. Equal specs have equal proposals, also after a restart of the daemon.

        Raises
        ------
        InvalidArgumentError
            With a violation for every field that is out of its bounds.
        FailedPreconditionError
            Nothing is missing, the zones do not reach what is, or no volumes are within the bounds.
        """
        request = with_request_id(pb.ProposePlanRequest(parent=patient, spec=spec))
        return self._operations.carry_out(
            lambda: self._channel.call(self._stub.ProposePlan, request),
            pb.Proposal(),
            doing="made the proposal",
            progress=progress,
        )

    def arrange(self, parts: dict[str, simulation_pb2.SimulationSpec]) -> pb.FaceArrangement:
        """Which parts of a face have to be simulated together. Each plan names the model of its
        part. An arranged part with a `model_spec` needs that model built first.

        Raises
        ------
        FailedPreconditionError
            Parts touch, but differ in tissue or fat, or are drawn on the charts of their models.
        """
        request = pb.ArrangeFaceRequest(parts=[pb.FacePart(name=name, plan=plan) for name, plan in parts.items()])
        return self._channel.call(self._stub.ArrangeFace, request)

    def deliver(
        self,
        plan: simulation_pb2.SimulationSpec,
        *,
        max_pass_ml: Optional[float] = None,
        tunnel_spacing_mm: Optional[float] = None,
        compare: bool = False,
    ) -> pb.Delivery:
        """The injection list of a plan; with `compare` also how far the skin of the plan as given
        lies from that of the plan.
        """
        request = pb.PlanDeliveryRequest(
            plan=plan, max_pass_ml=max_pass_ml, tunnel_spacing_mm=tunnel_spacing_mm, compare=compare
        )
        return self._channel.call(self._stub.PlanDelivery, request)
