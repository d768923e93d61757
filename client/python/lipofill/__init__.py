"""Client of lipofilld, which simulates facial fat grafting. Research and planning aid, not a
medical device.

    import lipofill

    plan = lipofill.Plan.load("jaw_angle.json")
    with lipofill.Connection() as connection, connection.run(plan) as run:
        with run.watch(meshes=["skin"], fields=["skin.displacement"]) as frames:
            for frame in frames:
                print(frame.time_s, frame["skin.displacement"].max())
        print(run.wait().summary)

Lengths are in mm, volumes in mL, pressures in Pa, times in s; names say so. Messages are those of
lipofill.v1; their reference is core/doc/api.md. Errors are LipofillError and its subclasses.
"""

from lipofill.arrays import Array
from lipofill.connection import Connection
from lipofill.credentials import Credentials
from lipofill.daemon import Daemon
from lipofill.errors import (
    AbortedError,
    AlreadyExistsError,
    CancelledError,
    DataLossError,
    DeadlineExceededError,
    FailedPreconditionError,
    FieldViolation,
    InvalidArgumentError,
    LipofillError,
    NotFoundError,
    PermissionDeniedError,
    ResourceExhaustedError,
    SimulationFailedError,
    UnauthenticatedError,
    UnavailableError,
)
from lipofill.frames import Frame, Meshes
from lipofill.places import at_chart, at_position, box, by_landmarks, constant, disc, samples
from lipofill.plans import Plan
from lipofill.progress import Progress, print_progress
from lipofill.retries import RetryPolicy
from lipofill.runs import Run
from lipofill.series import Series
from lipofill.shapes import Shape
from lipofill.simulation import Simulation
from lipofill.volumes import DicomSeries, Skin, convert_surface, extract_skin, list_series
from lipofill.watching import Watch

__version__ = "0.1.0"
__all__ = [
    "AbortedError",
    "AlreadyExistsError",
    "Array",
    "CancelledError",
    "Connection",
    "Credentials",
    "Daemon",
    "DicomSeries",
    "DataLossError",
    "DeadlineExceededError",
    "FailedPreconditionError",
    "FieldViolation",
    "Frame",
    "InvalidArgumentError",
    "LipofillError",
    "Meshes",
    "NotFoundError",
    "PermissionDeniedError",
    "Plan",
    "Progress",
    "ResourceExhaustedError",
    "RetryPolicy",
    "Run",
    "Series",
    "Shape",
    "Simulation",
    "SimulationFailedError",
    "Skin",
    "UnauthenticatedError",
    "UnavailableError",
    "Watch",
    "at_chart",
    "at_position",
    "box",
    "by_landmarks",
    "constant",
    "convert_surface",
    "disc",
    "extract_skin",
    "list_series",
    "print_progress",
    "samples",
]
