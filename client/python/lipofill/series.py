"""The time series of a simulation, a column a figure."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List

import numpy as np
import numpy.typing as npt

from lipofill.channel import Channel
from lipofill.v1 import simulation_pb2
from lipofill.v1 import simulation_service_pb2 as pb


class Series:
    """Figures of every step. ``series["max_pressure_pa"]`` is a float64 array, a value a row; names
    as in SeriesRow, with units.

    ``probe_thickness_mm`` and ``probe_pressure_pa`` have a column a probe of the plan. Whole rows
    are in ``rows``.
    """

    def __init__(self, rows: Iterable[simulation_pb2.SeriesRow]) -> None:
        self.rows: List[simulation_pb2.SeriesRow] = list(rows)
        self._columns: Dict[str, npt.NDArray[Any]] = {}

    @staticmethod
    def names() -> List[str]:
        """Of the columns."""
        fields = simulation_pb2.SeriesRow.DESCRIPTOR.fields
        return [field.name for field in fields if field.message_type is None]

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        if name not in self._columns:
            if name not in self.names():
                raise KeyError(name)
            values = [getattr(row, name) for row in self.rows]
            self._columns[name] = np.array([list(value) if name.startswith("probe_") else value for value in values])
        return self._columns[name]


def fetch_series(channel: Channel, simulation: str) -> Series:
    """All rows of a simulation so far."""
    rows: List[simulation_pb2.SeriesRow] = []
    while True:
        after = rows[-1].step if rows else 0
        request = pb.GetSeriesRequest(name=simulation, after_step=after)
        response = channel.call(channel.simulation_stub.GetSeries, request)
        rows.extend(response.rows)
        if not response.more or not response.rows:
            return Series(rows)
