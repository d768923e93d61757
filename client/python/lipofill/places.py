"""Points on the skin and shapes of zones, for plans built in code."""

from __future__ import annotations

from typing import Mapping, Union

import numpy as np
import numpy.typing as npt

from lipofill.v1 import geometry_pb2, simulation_pb2

Shape = Union[geometry_pb2.ChartBox, simulation_pb2.Disc, geometry_pb2.FieldSamples, str]


def at_chart(xi: float, eta: float) -> geometry_pb2.SkinPoint:
    """A place by its chart coordinates: (0, 0) is the first corner of the region, (1, 1) the
    third.
    """
    return geometry_pb2.SkinPoint(chart=geometry_pb2.ChartPoint(xi=xi, eta=eta))


def at_position(x_mm: float, y_mm: float, z_mm: float) -> geometry_pb2.SkinPoint:
    """The place of the skin nearest to a point in the frame of the scan."""
    return geometry_pb2.SkinPoint(position_mm=geometry_pb2.Vector3(x=x_mm, y=y_mm, z=z_mm))


def by_landmarks(
    weights: Mapping[str, float], *, left_mm: float = 0.0, up_mm: float = 0.0, forward_mm: float = 0.0
) -> geometry_pb2.SkinPoint:
    """The weighted mean of landmarks, moved along the head's axes, on the skin."""
    point = geometry_pb2.LandmarkPoint(weights=weights, left_mm=left_mm, up_mm=up_mm, forward_mm=forward_mm)
    return geometry_pb2.SkinPoint(landmarks=point)


def box(xi_min: float, xi_max: float, eta_min: float, eta_max: float) -> geometry_pb2.ChartBox:
    """A rectangle of the chart."""
    return geometry_pb2.ChartBox(xi_min=xi_min, xi_max=xi_max, eta_min=eta_min, eta_max=eta_max)


def disc(centre: geometry_pb2.SkinPoint, radius_mm: float) -> simulation_pb2.Disc:
    """A round zone, by the straight distance from its centre."""
    return simulation_pb2.Disc(centre=centre, radius_mm=radius_mm)


def samples(values: npt.ArrayLike) -> geometry_pb2.FieldSamples:
    """A field by its values at points spaced evenly over the chart, both ends included: (n_eta,
    n_xi). Of a zone: where it is painted, that is at least 0.5.
    """
    array = np.asarray(values, dtype=float)
    return geometry_pb2.FieldSamples(n_xi=array.shape[1], n_eta=array.shape[0], values=array.ravel())


def constant(value: float) -> geometry_pb2.ScalarField:
    """A field that is the same everywhere."""
    return geometry_pb2.ScalarField(constant=value)
