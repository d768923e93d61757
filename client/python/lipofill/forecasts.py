"""What is known of a plan's result, how well, and what is left of it after months."""

from __future__ import annotations

from typing import Optional, Sequence

from lipofill.channel import Channel
from lipofill.operations import Operations
from lipofill.progress import ProgressCallback
from lipofill.retries import with_request_id
from lipofill.v1 import forecast_service_pb2 as pb


class Forecasts:
    """Makes forecasts and estimates retention."""

    def __init__(self, channel: Channel, operations: Operations) -> None:
        self._channel = channel
        self._operations = operations
        self._stub = channel.forecast_stub

    def make(
        self, patient: str, spec: pb.ForecastSpec, *, progress: Optional[ProgressCallback] = None
    ) -> pb.Forecast:
        """Makes a forecast and waits for it. An interruption (Ctrl-C, an exception of `progress`)
        cancels the work too. Equal specs have equal forecasts, also after a restart of the daemon.

        Raises
        ------
        InvalidArgumentError
            With a violation for every field that is out of its bounds.
        FailedPreconditionError
            The plan has to be stepped, or fewer than half of the members settle.
        """
        request = with_request_id(pb.MakeForecastRequest(parent=patient, spec=spec))
        return self._operations.carry_out(
            lambda: self._channel.call(self._stub.MakeForecast, request),
            pb.Forecast(),
            doing="made the forecast",
            progress=progress,
        )

    def inputs(self, patient: str, spec: pb.ForecastSpec) -> Sequence[pb.UncertainInput]:
        """What a forecast of this spec takes as uncertain, with its sources, but for retention.
        Nothing is solved for that.
        """
        request = with_request_id(pb.MakeForecastRequest(parent=patient, spec=spec, validate_only=True))
        forecast = pb.Forecast()
        self._channel.call(self._stub.MakeForecast, request).response.Unpack(forecast)
        return list(forecast.inputs)

    def retention(
        self,
        retention: Optional[pb.Retention] = None,
        *,
        months: Sequence[float] = (),
        injected_ml: Optional[float] = None,
        follow_up: Optional[pb.FollowUp] = None,
        wanted_ml: Optional[float] = None,
    ) -> pb.RetentionEstimate:
        """The share of fat that is left after months, sharpened by a follow-up of `injected_ml`,
        and what to inject so that `wanted_ml` is left after the last of the months.
        """
        request = pb.EstimateRetentionRequest(
            retention=retention, months=months, injected_ml=injected_ml, follow_up=follow_up, wanted_ml=wanted_ml
        )
        return self._channel.call(self._stub.EstimateRetention, request)
