"""The simulations of a daemon, and the shapes that it finds at once."""

from __future__ import annotations

from typing import Iterator, Mapping, Optional, Sequence, Union

from lipofill.channel import Channel
from lipofill.shapes import Shape, assemble_shape
from lipofill.simulation import Simulation
from lipofill.v1 import simulation_pb2 as messages
from lipofill.v1 import simulation_service_pb2 as pb

# Setting up a simulation of a large model takes the daemon minutes.
CREATION_TIMEOUT_S = 600.0


class Simulations:
    """The simulations of a daemon."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._stub = channel.simulation_stub

    def __getitem__(self, name: str) -> Simulation:
        """A handle; the daemon is not asked whether it exists."""
        return Simulation(self._channel, name)

    def create(
        self,
        spec: messages.SimulationSpec,
        *,
        simulation_id: str = "",
        display_name: str = "",
        start: bool = False,
    ) -> Simulation:
        """A simulation of the model that the spec names.

        Raises
        ------
        InvalidArgumentError
            With a violation for every field that is out of its bounds.
        """
        request = pb.CreateSimulationRequest(
            simulation_id=simulation_id, display_name=display_name, spec=spec, start=start
        )
        made = self._channel.call(self._stub.CreateSimulation, request, timeout_s=CREATION_TIMEOUT_S)
        return Simulation(self._channel, made.name)

    def check(self, spec: messages.SimulationSpec) -> messages.Simulation:
        """What `create` would answer, or raise; nothing is kept."""
        request = pb.CreateSimulationRequest(spec=spec, validate_only=True)
        return self._channel.call(self._stub.CreateSimulation, request, timeout_s=CREATION_TIMEOUT_S)

    def check_plan(self, spec: messages.SimulationSpec) -> pb.CheckPlanResponse:
        """Where the zones of a plan are on the model that the spec names, what is wrong with it and
        what is worth knowing.

        A plan that is wrong raises nothing: see ``violations`` of what is returned. No simulation
        is made.
        """
        request = pb.CheckPlanRequest(spec=spec)
        return self._channel.call(self._stub.CheckPlan, request, timeout_s=CREATION_TIMEOUT_S)

    def find_shape(
        self,
        plan: Union[messages.SimulationSpec, str],
        *,
        volumes_ml: Optional[Mapping[int, float]] = None,
        added_ml: Optional[Mapping[str, float]] = None,
        drag: str = "",
        from_rest: bool = False,
        fields: Sequence[str] = (),
        with_sensitivities: bool = False,
    ) -> Shape:
        """The settled shape of a plan with other volumes, found at once. Nothing of it is kept.

        Parameters
        ----------
        plan : SimulationSpec or str
            A plan that names its model, or a simulation: its plan with what was injected since.
        volumes_ml : mapping of int to float
            Volumes in place of those of the plan's injections, by their place in it from 0.
        added_ml : mapping of str to float
            Fat that zones have beyond the plan's, by zone; negative: taken out.
        drag : str
            Calls of one drag go on from one another's shapes, at a fraction of the cost.
        from_rest : bool
            Find the shape from rest all the same: equal plans give equal bytes.
        fields : sequence of str
            Of the meshes "skin" and "scan"; default: displacement and pressure of the skin.
        with_sensitivities : bool
            Say what a little more of each volume, stiffness and thickness does.

        Raises
        ------
        FailedPreconditionError
            For a plan that has to be stepped; the message names the field that asks for it.
        AbortedError
            Where a newer call of the same drag took the place of this one.
        """
        request = pb.FindShapeRequest(
            drag=drag, from_rest=from_rest, fields=fields, with_sensitivities=with_sensitivities
        )
        if isinstance(plan, str):
            request.simulation = plan
        else:
            request.spec.CopyFrom(plan)
        for index, volume_ml in (volumes_ml or {}).items():
            request.injections.add(index=index, volume_ml=volume_ml)
        for zone, volume_ml in (added_ml or {}).items():
            request.added.add(zone=zone, volume_ml=volume_ml)
        stream = self._stub.FindShape(request, metadata=self._channel.metadata())
        return assemble_shape(self._channel.stream_items(stream))

    def list(self) -> Iterator[messages.Simulation]:
        """All, by name."""
        return self._channel.paged(self._stub.ListSimulations, pb.ListSimulationsRequest(), "simulations")
