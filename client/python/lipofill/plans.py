"""Plans: what is injected where, of files or built in code."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Mapping, Optional, Sequence, Union

from google.protobuf import json_format

from lipofill.errors import FieldViolation, InvalidArgumentError
from lipofill.landmarks import load_landmarks
from lipofill.places import Shape, constant
from lipofill.plan_fields import violations_of
from lipofill.scans import UNITS, unit_of
from lipofill.v1 import geometry_pb2, model_pb2, plan_pb2, simulation_pb2

PathLike = Union[str, "os.PathLike[str]"]
Field = Union[float, geometry_pb2.ScalarField]


def _field(value: Field) -> geometry_pb2.ScalarField:
    return value if isinstance(value, geometry_pb2.ScalarField) else constant(value)


class Plan:
    """All that a prediction needs: the face, its model, and what is injected. The JSON of
    `lipofill run`.

    Attributes
    ----------
    message : lipofill.v1.Plan
        Everything; the methods below put the usual things into it.
    folder : Path
        Files that the plan names are relative to it.

    Examples
    --------
    >>> plan = Plan("plate").square(60, 60, n_xi=12, n_eta=12)
    >>> figures = {"youngs_modulus_kpa": 100, "poisson_ratio": 0.45, "density_kg_m3": 1100}
    >>> plan.layer("skin", thickness_mm=2, **figures)
    >>> plan.film("deep", below="skin", zones={"middle": box(0.25, 0.75, 0.25, 0.75)})
    >>> plan.inject("middle", volume_ml=0.5, rate_ml_per_s=1.0).settle(end_s=20)
    """

    def __init__(self, name: str = "", description: str = "", *, folder: PathLike = ".") -> None:
        self.message = plan_pb2.Plan(name=name, description=description)
        self.folder = Path(folder)

    @classmethod
    def load(cls, path: PathLike) -> Plan:
        """Reads a plan file. Fields are checked against the schema here, what they mean by the
        daemon.

        Raises
        ------
        InvalidArgumentError
            Naming the file, and as a violation the field that does not exist, with the nearest name
            that does, or the field whose value is no name it knows, with those it does.
        OSError
        """
        path = Path(path)
        plan = cls.from_json(path.read_text(encoding="utf-8"), folder=path.parent, source=str(path))
        if not plan.message.name:
            plan.message.name = path.stem
        return plan

    @classmethod
    def from_json(cls, text: str, *, folder: PathLike = ".", source: str = "the plan") -> Plan:
        """A plan from the text of a plan file."""
        plan = cls(folder=folder)
        try:
            json_format.Parse(text, plan.message)
        except json_format.ParseError as error:
            raise InvalidArgumentError(f"{source}: {error}", violations=violations_of(str(error))) from None
        return plan

    def to_json(self) -> str:
        """The plan file; numbers have every digit."""
        content = json_format.MessageToDict(self.message, preserving_proto_field_name=True)
        return json.dumps(content, indent=1, ensure_ascii=False) + "\n"

    def save(self, path: PathLike) -> None:
        """Writes the plan file. Files that the plan names are then relative to where it is
        written.
        """
        path = Path(path)
        saved = plan_pb2.Plan()
        saved.CopyFrom(self.message)
        for scan in (saved.scan, saved.bone):
            for field in ("file", "landmarks_file"):
                if getattr(scan, field):
                    setattr(scan, field, os.path.relpath(self.folder / getattr(scan, field), path.parent))
        copy = Plan(folder=path.parent)
        copy.message.CopyFrom(saved)
        path.write_text(copy.to_json(), encoding="utf-8")

    def copy(self) -> Plan:
        """A plan of its own, to be changed."""
        copy = Plan(folder=self.folder)
        copy.message.CopyFrom(self.message)
        return copy

    @property
    def model(self) -> model_pb2.ModelSpec:
        return self.message.model

    @property
    def simulation(self) -> simulation_pb2.SimulationSpec:
        return self.message.simulation

    def square(
        self, length_xi_mm: float, length_eta_mm: float, *, n_xi: Optional[int] = None, n_eta: Optional[int] = None
    ) -> Plan:
        """A flat plate, in n_xi x n_eta hexahedra; the daemon chooses what is left out."""
        self.model.square.length_xi_mm, self.model.square.length_eta_mm = length_xi_mm, length_eta_mm
        self._divide(n_xi, n_eta)
        return self

    def _divide(self, n_xi: Optional[int], n_eta: Optional[int]) -> None:
        for field, count in (("n_xi", n_xi), ("n_eta", n_eta)):
            self.model.ClearField(field)
            if count is not None:
                setattr(self.model, field, count)

    def face(
        self,
        scan: PathLike,
        *,
        corners: Sequence[geometry_pb2.SkinPoint] = (),
        around: Sequence[str] = (),
        n_xi: Optional[int] = None,
        n_eta: Optional[int] = None,
        landmarks: Optional[PathLike] = None,
        unit: str = "mm",
    ) -> Plan:
        """A region of a scan, in n_xi x n_eta hexahedra: around named regions of the face, or
        between four corners, anticlockwise seen from outside. With neither it follows from the
        zones of the films. The daemon chooses the numbers that are left out.
        """
        self.message.scan.file, self.message.scan.unit = os.fspath(scan), unit_of(unit)
        if landmarks is not None:
            self.message.scan.landmarks_file = os.fspath(landmarks)
        del self.model.scan_region.corners[:]
        self.model.scan_region.corners.extend(corners)
        self.model.scan_region.ClearField("around")
        if around:
            self.model.scan_region.around.regions.extend(around)
        self.model.scan_region.SetInParent()
        self._divide(n_xi, n_eta)
        return self

    def layer(
        self,
        name: str,
        *,
        thickness_mm: Optional[Field] = None,
        youngs_modulus_kpa: Optional[float] = None,
        poisson_ratio: Optional[float] = None,
        density_kg_m3: Optional[float] = None,
        elements_through: Optional[int] = None,
        prestress_kpa: Optional[float] = None,
        law: Optional[str] = None,
    ) -> Plan:
        """A layer of tissue, from the skin inwards; figures left out come from
        ``model.tissue_preset``.

        ``law`` is ``"COROTATIONAL"``, the paper's, or ``"NEO_HOOKEAN"``, which keeps the tissue's
        volume at any strain.
        """
        self.model.layers.add(
            name=name,
            thickness_mm=None if thickness_mm is None else _field(thickness_mm),
            youngs_modulus_kpa=youngs_modulus_kpa,
            poisson_ratio=poisson_ratio,
            density_kg_m3=density_kg_m3,
            elements_through=elements_through,
            prestress_kpa=prestress_kpa,
            law=None if law is None else model_pb2.TissueLayer.Law.Value(law),
        )
        return self

    def film(
        self,
        name: str,
        *,
        below: str,
        zones: Mapping[str, Shape],
        n_xi: Optional[int] = None,
        n_eta: Optional[int] = None,
        extent: Optional[geometry_pb2.ChartBox] = None,
        rest_thickness_mm: Optional[Field] = None,
        edge: Optional[simulation_pb2.ZoneEdge] = None,
    ) -> Plan:
        """A film of fat under the layer `below`. A zone is a box, a disc or samples (painted), or a
        region's name. Cells that are not counted are two hexahedra wide; an edge that is left out
        is held by septa with assumed figures on a face, and rigid on a square.
        """
        film = self.simulation.films.add(
            name=name, below_layer=below, n_xi=n_xi, n_eta=n_eta, extent=extent, edge=edge
        )
        if rest_thickness_mm is not None:
            film.rest_thickness_mm.CopyFrom(_field(rest_thickness_mm))
        for zone, shape in zones.items():
            if isinstance(shape, str):
                film.zones.add(name=zone, region=shape)
            elif isinstance(shape, simulation_pb2.Disc):
                film.zones.add(name=zone, disc=shape)
            elif isinstance(shape, geometry_pb2.FieldSamples):
                film.zones.add(name=zone, painted=shape)
            else:
                film.zones.add(name=zone, box=shape)
        return self

    def inject(
        self,
        zone: str,
        *,
        volume_ml: float,
        rate_ml_per_s: float,
        start_s: Optional[float] = None,
        site: Optional[geometry_pb2.SkinPoint] = None,
    ) -> Plan:
        """An injection; without a start it begins when the one before it has ended."""
        self.simulation.injections.add(
            zone=zone, volume_ml=volume_ml, rate_ml_per_s=rate_ml_per_s, start_s=start_s, site=site
        )
        return self

    def settle(self, *, end_s: float = 120.0) -> Plan:
        """Only the shape in the end counts: as few steps as that takes."""
        self.simulation.time.goal = simulation_pb2.TimeControl.SETTLED_SHAPE
        self.simulation.time.end_s = end_s
        return self

    def scan_path(self) -> Optional[Path]:
        return self.folder / self.message.scan.file if self.message.scan.file else None

    def bone_path(self) -> Optional[Path]:
        return self.folder / self.message.bone.file if self.message.bone.file else None

    def model_with_landmarks(self) -> model_pb2.ModelSpec:
        """The model, the landmarks of the plan's landmarks file in its scan region, which follows
        from the zones where the plan does not give it.
        """
        spec = model_pb2.ModelSpec()
        spec.CopyFrom(self.model)
        _take_region_from_zones(spec, self.simulation)
        if not self.message.scan.landmarks_file:
            return spec
        if not spec.HasField("scan_region"):
            raise InvalidArgumentError(
                "landmarks without a scan region",
                violations=[FieldViolation("scan.landmarks_file", "is given, but model.scan_region is not")],
            )
        path = os.fspath(self.folder / self.message.scan.landmarks_file)
        load_landmarks(path, spec.scan_region, scan_unit=unit_name(self.message.scan.unit))
        return spec


def _take_region_from_zones(spec: model_pb2.ModelSpec, simulation: simulation_pb2.SimulationSpec) -> None:
    """Named regions and discs of all films, each once; boxes and painted zones lie on a chart that
    is not there yet.
    """
    region = spec.scan_region
    if not spec.HasField("scan_region") or region.corners or region.around.regions or region.around.discs:
        return
    for zone in (zone for film in simulation.films for zone in film.zones):
        if zone.HasField("region") and zone.region not in region.around.regions:
            region.around.regions.append(zone.region)
        elif zone.HasField("disc") and not zone.disc.centre.HasField("chart"):
            region.around.discs.add(centre=zone.disc.centre, radius_mm=zone.disc.radius_mm)


def unit_name(unit: plan_pb2.ScanUnit) -> str:
    """ "mm", "cm" or "m"; unspecified is millimetres."""
    return next((name for name, value in UNITS.items() if value == unit), "mm")
