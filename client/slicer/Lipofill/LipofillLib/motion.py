"""The skin as it moves: frames that are kept for the slider, in bounded memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import List

import numpy as np
import numpy.typing as npt

#: So many frames of a face of 50,000 points are 200 MB.
MOST_FRAMES = 240
#: The scalars on the skin, their names in Slicer with their units.
LIFT, PRESSURE, DISPLACEMENT = "lift_mm", "pressure_pa", "displacement_mm"
TITLES = {LIFT: "Lift (mm)", PRESSURE: "Pressure of the fat (Pa)"}


@dataclass(frozen=True)
class Still:
    """The skin at a time.

    Attributes
    ----------
    time_s : float
        Simulated.
    displacement_mm : (n, 3) array
        In LPS.
    pressure_pa : (n,) array
        Of the fat below each point; 0 where there is none.
    """

    time_s: float
    displacement_mm: npt.NDArray[np.float32]
    pressure_pa: npt.NDArray[np.float32]

    @property
    def lift_mm(self) -> npt.NDArray[np.float32]:
        """How far each point has moved."""
        return np.linalg.norm(self.displacement_mm, axis=1).astype(np.float32)


class Motion:
    """The skin at rest and every still that is kept. Where they become too many, every second one
    goes; the newest always stays.

    Attributes
    ----------
    points_mm : (n, 3) array
        At rest, in LPS.
    cells : (m, 3) array
    """

    def __init__(self, points_mm: npt.NDArray[np.float64], cells: npt.NDArray[np.uint32]) -> None:
        self.points_mm = points_mm
        self.cells = cells
        self.stills: List[Still] = []

    def __len__(self) -> int:
        return len(self.stills)

    def add(self, still: Still) -> None:
        if len(self.stills) >= MOST_FRAMES:
            self.stills = self.stills[::2]
        self.stills.append(still)

    def points_at(self, index: int) -> npt.NDArray[np.float64]:
        """Where the points are in a still, in LPS."""
        return np.asarray(self.points_mm, dtype=np.float64) + self.stills[index].displacement_mm

    def most(self, scalar: str) -> float:
        """The largest value of LIFT or PRESSURE in all stills, for one scale of colours."""
        values = (still.lift_mm if scalar == LIFT else still.pressure_pa for still in self.stills)
        return max((float(each.max(initial=0.0)) for each in values), default=0.0)
