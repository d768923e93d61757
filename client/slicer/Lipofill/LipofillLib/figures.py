"""The figures of a result, for a table: name, value, unit."""

from __future__ import annotations

from typing import List, Tuple

from lipofill.v1 import simulation_pb2

Row = Tuple[str, str, str]
NOTICE = "Research and planning aid, not a medical device."


def rows_of(simulation: simulation_pb2.Simulation) -> List[Row]:
    """The figures of a simulation and of its zones, then its remarks (which have no unit)."""
    summary = simulation.summary
    rows = [
        ("state", simulation_pb2.Simulation.State.Name(simulation.state), ""),
        ("injected", f"{summary.injected_ml:.3f}", "mL"),
        ("largest lift of the skin", f"{summary.skin_max_displacement_mm:.2f}", "mm"),
        ("volume that the skin gained", f"{summary.skin_volume_change_ml:.3f}", "mL"),
        ("largest pressure", f"{summary.max_pressure_pa:.0f}", "Pa"),
    ]
    for zone in summary.zones:
        rows.append((f"{zone.name}: volume", f"{zone.volume_ml:.3f}", "mL"))
        rows.append((f"{zone.name}: mean pressure", f"{zone.mean_pressure_pa:.0f}", "Pa"))
        rows.append((f"{zone.name}: largest thickness of the fat", f"{zone.max_thickness_mm:.2f}", "mm"))
    rows += [("remark", remark, "") for remark in summary.remarks]
    return rows
