#!/usr/bin/env python3
"""The paper's Figure 1: height at the centre of a square over time, for three time steps,
resolutions and stiffnesses.

A film lies between a rigid square and a soft one whose rim is clamped. It starts as a tunnel in the
middle, which sinks and spreads. Every run goes through `lipofill run --spawn`, with a plan made
from plans/square.json.

  figure_1.py --lipofill BIN --out FOLDER [--page PAGE.md]   CSVs and plots; the measured figures go into the page
  figure_1.py --lipofill BIN --check                         a small version without plots: fails unless curves
                                                             converge and order by stiffness

Exit code 1: they do not; 2: a run failed. The same results give the same bytes.
"""

import argparse
import csv
import dataclasses
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import textwrap

BASE_PLAN = pathlib.Path(__file__).parent / "plans" / "square.json"
SIDE_MM = 60.0
REST_MM = 1.0


@dataclasses.dataclass(frozen=True)
class Run:
    """One curve of the figure."""

    step_ms: float
    film_cells: int  # a side; odd, so that a cell's centre is the centre of the square
    modulus_kpa: float

    @property
    def name(self):
        return f"step_{self.step_ms:g}_cells_{self.film_cells}_modulus_{self.modulus_kpa:g}"


@dataclasses.dataclass(frozen=True)
class Study:
    steps_ms: tuple  # coarse to fine
    film_cells: tuple  # coarse to fine
    moduli_kpa: tuple  # soft to stiff, doubling
    common_step_ms: float  # of the runs that do not vary it
    end_s: float
    least_order_in_time: float
    least_order_in_space: float

    def run(self, step_ms=None, film_cells=None, modulus_kpa=None):
        return Run(step_ms or self.common_step_ms, film_cells or self.film_cells[1], modulus_kpa or self.moduli_kpa[1])

    def by_step(self):
        return [self.run(step_ms=step) for step in self.steps_ms]

    def by_resolution(self):
        return [self.run(film_cells=cells) for cells in self.film_cells]

    def by_modulus(self):
        return [self.run(modulus_kpa=modulus) for modulus in self.moduli_kpa]

    def all_runs(self):
        return list(dict.fromkeys(self.by_step() + self.by_resolution() + self.by_modulus()))


FIGURE = Study((40, 20, 10), (9, 15, 25), (50, 100, 200), 20, 8, 0.8, 1.8)
CHECK = Study((80, 40, 20), (5, 9, 15), (50, 100, 200), 40, 0.8, 0.7, 1.3)


def tunnel_mm(x, y):
    """Thickness at the start: 3 mm at the centre, 12 mm wide and 31 mm long at half height, five
    times differentiable.
    """
    across = math.cos(math.pi * x / 40.0) ** 6 if abs(x) < 20.0 else 0.0
    along = (1.0 - (y / 27.0) ** 4) ** 6 if abs(y) < 27.0 else 0.0
    return REST_MM + 2.0 * across * along


def make_plan(run, end_s):
    plan = json.loads(BASE_PLAN.read_text())
    plan["description"] = "A run of the paper's Figure 1."
    plan["model"]["square"] = {"length_xi_mm": SIDE_MM, "length_eta_mm": SIDE_MM}
    plan["model"]["n_xi"] = plan["model"]["n_eta"] = 2 * run.film_cells
    plan["model"]["layers"][0]["youngs_modulus_kpa"] = run.modulus_kpa
    simulation = plan["simulation"]
    film = simulation["films"][0]
    film["n_xi"] = film["n_eta"] = run.film_cells
    film["rest_thickness_mm"] = {"constant": REST_MM}
    # Samples at the corners, sides and centres of cells: a cell starts with the thickness at its
    # centre, exactly.
    n = 2 * run.film_cells + 1
    places = [SIDE_MM * (i / (n - 1) - 0.5) for i in range(n)]
    values = [round(tunnel_mm(x, y), 6) for y in places for x in places]
    film["initial_thickness_mm"] = {"samples": {"n_xi": n, "n_eta": n, "values": values}}
    simulation["time"] = {"step_ms": run.step_ms, "end_s": end_s, "settle_skin_speed_mm_per_s": 0}
    simulation["probes"] = [{"name": "centre", "place": {"chart": {"xi": 0.5, "eta": 0.5}}}]
    return plan


def simulate(lipofill, run, end_s, folder):
    """Height [mm] by time [ms], and the largest relative error of the film's volume."""
    plan = folder / f"{run.name}.json"
    plan.write_text(json.dumps(make_plan(run, end_s)))
    out = folder / run.name
    subprocess.run(
        [lipofill, "run", plan, "--spawn", "--out", out, "--interval-ms", "0", "--no-picture", "--quiet"], check=True
    )
    heights = {0: tunnel_mm(0.0, 0.0)}
    volumes = []
    with open(out / "series.csv", newline="") as rows:
        for row in csv.DictReader(rows):
            heights[round(1e3 * float(row["time_s"]))] = float(row["probe_centre_thickness_mm"])
            volumes.append(float(row["film_volume_ml"]))
    return heights, max(abs(volume / volumes[0] - 1.0) for volume in volumes)


def simulate_all(lipofill, study):
    """Heights by run, and the largest relative error of volume."""
    heights, volume_error = {}, 0.0
    with tempfile.TemporaryDirectory() as folder:
        for number, run in enumerate(study.all_runs(), 1):
            print(
                f"figure_1: run {number} of {len(study.all_runs())}, {run.step_ms:g} ms, {run.film_cells} x "
                f"{run.film_cells} cells, {run.modulus_kpa:g} kPa",
                flush=True,
            )
            heights[run], error = simulate(lipofill, run, study.end_s, pathlib.Path(folder))
            volume_error = max(volume_error, error)
    return heights, volume_error


def common_times(study):
    """Times that all runs have [ms]."""
    step = round(max(study.steps_ms))
    return range(0, round(1e3 * study.end_s) + 1, step)


def rms_difference(a, b, times):
    return math.sqrt(sum((a[t] - b[t]) ** 2 for t in times) / len(times))


def observed_order(sizes, coarse, fine):
    """p of an error c s^p: coarse/fine = (s0^p - s1^p)/(s1^p - s2^p), by bisection."""
    low, high = 0.01, 8.0
    for _ in range(60):
        p = 0.5 * (low + high)
        ratio = (sizes[0] ** p - sizes[1] ** p) / (sizes[1] ** p - sizes[2] ** p)
        low, high = (p, high) if ratio < coarse / fine else (low, p)
    return 0.5 * (low + high)


@dataclasses.dataclass
class Convergence:
    what: str
    sizes: list  # of the time step [ms] or a film cell [mm], coarse to fine
    differences: list  # RMS between neighbours [mm]

    @property
    def order(self):
        return observed_order(self.sizes, *self.differences)


def measure(study, heights):
    """Both convergences, and how far the curves part where time is multiplied by stiffness."""
    times = common_times(study)

    def differences(runs):
        return [rms_difference(heights[a], heights[b], times) for a, b in zip(runs, runs[1:])]

    step = Convergence("time step [ms]", list(study.steps_ms), differences(study.by_step()))
    cell = Convergence("film cell [mm]", [SIDE_MM / n for n in study.film_cells], differences(study.by_resolution()))
    soft, middle, stiff = (heights[run] for run in study.by_modulus())
    half = [t for t in times if 2 * t in soft]
    collapse = max(max(abs(middle[t] - soft[2 * t]), abs(stiff[t] - middle[2 * t])) for t in half)
    return step, cell, collapse


def find_faults(study, heights, step, cell, volume_error):
    """What contradicts the paper's claims."""
    faults = []
    for study_of, least_order in ((step, study.least_order_in_time), (cell, study.least_order_in_space)):
        if not study_of.differences[1] < study_of.differences[0]:
            faults.append(f"differences do not shrink with the {study_of.what}: {study_of.differences}")
        elif study_of.order < least_order:
            faults.append(f"order {study_of.order:.2f} in the {study_of.what}, at least {least_order} expected")
    soft, middle, stiff = (heights[run] for run in study.by_modulus())
    if not all(soft[t] > middle[t] > stiff[t] for t in common_times(study) if t > 0):
        faults.append("heights do not order by stiffness")
    if volume_error > 1e-12:
        faults.append(f"the film's volume changes by {volume_error:.1e}")
    return faults


def write_curves(path, study, runs, labels, heights):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time_s"] + [f"height_mm_{label}" for label in labels])
        for t in common_times(study):
            writer.writerow([f"{1e-3 * t:g}"] + [f"{heights[run][t]:.6f}" for run in runs])


def write_convergence(path, step, cell):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["refined", "coarse", "middle", "fine", "coarse_to_middle_mm", "middle_to_fine_mm", "order"])
        for study in (step, cell):
            writer.writerow(
                [study.what]
                + [f"{size:g}" for size in study.sizes]
                + [f"{difference:.3e}" for difference in study.differences]
                + [f"{study.order:.2f}"]
            )


def write_page(page, step, cell, collapse, volume_error):
    """Replaces what stands between the page's two marks."""
    lines = [
        "| refined | coarse, middle, fine | coarse to middle | middle to fine | observed order |",
        "|---|---|---|---|---|",
    ]
    for study in (step, cell):
        sizes = ", ".join(f"{size:.3g}" for size in study.sizes)
        lines.append(
            f"| {study.what} | {sizes} | {1e3 * study.differences[0]:.2f} um | "
            f"{1e3 * study.differences[1]:.2f} um | {study.order:.2f} |"
        )
    told = (
        f"The film's volume changes by at most {volume_error:.0e} of itself in any of the runs. "
        f"Drawn over time multiplied by stiffness, the three curves differ by at most {1e3 * collapse:.1f} um."
    )
    lines += ["", *textwrap.wrap(told, 120)]
    before, _, after = page.read_text().split("<!-- measured -->")
    page.write_text("<!-- measured -->".join([before, "\n" + "\n".join(lines) + "\n", after]))


def plot_curves(path, study, curves, heights, lower):
    """Plots pairs of a run and its label; `lower` draws the small plot below from its axes and
    colours.
    """
    from matplotlib import pyplot

    figure, (top, bottom) = pyplot.subplots(2, 1, figsize=(6.4, 5.6), height_ratios=[2, 1], layout="constrained")
    colours = ["#c8553d", "#2f6690", "#222222"]
    seconds = [1e-3 * t for t in common_times(study)]
    for (run, label), colour, line in zip(curves, colours, ["--", "-.", "-"]):
        top.plot(seconds, [heights[run][t] for t in common_times(study)], line, color=colour, label=label)
    top.set_xlabel("time [s]")
    top.set_ylabel("height of the film at the centre [mm]")
    top.set_xlim(0.0, study.end_s)
    top.grid(alpha=0.3)
    top.legend()
    lower(bottom, colours)
    bottom.grid(alpha=0.3)
    figure.savefig(path, metadata={"Date": None, "Creator": None} if path.suffix == ".svg" else None, dpi=130)
    pyplot.close(figure)


def draw_differences(study, curves, heights):
    """Distance of the two coarser curves from the finest, on a logarithmic axis."""
    finest, finest_label = heights[curves[-1][0]], curves[-1][1]

    def draw(axes, colours):
        times = [t for t in common_times(study) if t > 0]
        for (run, _), colour, line in zip(curves[:-1], colours, ["--", "-."]):
            axes.semilogy(
                [1e-3 * t for t in times], [1e3 * abs(heights[run][t] - finest[t]) for t in times], line, color=colour
            )
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"distance from\n{finest_label} [um]")
        axes.set_xlim(0.0, study.end_s)

    return draw


def draw_scaled(study, curves, heights):
    """Height over time multiplied by stiffness, relative to the curve in the middle."""
    reference = curves[1][0].modulus_kpa

    def draw(axes, colours):
        for (run, _), colour, line in zip(curves, colours, ["--", "-.", "-"]):
            times = [t for t in common_times(study) if t > 0]
            axes.semilogx(
                [1e-3 * t * run.modulus_kpa / reference for t in times],
                [heights[run][t] for t in times],
                line,
                color=colour,
            )
        axes.set_xlabel(f"time x E / ({reference:g} kPa) [s]")
        axes.set_ylabel("height [mm]")

    return draw


def write_figure(study, heights, out, step, cell, suffix):
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "figure_1", "svg.fonttype": "none"})
    curves = {
        "time_step": [(run, f"{run.step_ms:g} ms") for run in study.by_step()],
        "resolution": [(run, f"{run.film_cells} x {run.film_cells} cells") for run in study.by_resolution()],
        "stiffness": [(run, f"{run.modulus_kpa:g} kPa") for run in study.by_modulus()],
    }
    for name, runs in curves.items():
        labels = [label.replace(" ", "_") for _, label in runs]
        write_curves(out / f"{name}.csv", study, [run for run, _ in runs], labels, heights)
        lower = draw_scaled if name == "stiffness" else draw_differences
        plot_curves(out / f"{name}{suffix}", study, runs, heights, lower(study, runs, heights))
    write_convergence(out / "convergence.csv", step, cell)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lipofill", required=True, help="the command-line program; lipofilld lies beside it")
    parser.add_argument("--out", type=pathlib.Path, help="folder of CSVs and plots; made when missing")
    parser.add_argument("--page", type=pathlib.Path, help="page whose measured figures are replaced")
    parser.add_argument("--format", choices=["svg", "png"], default="svg", help="of the plots; default svg")
    parser.add_argument("--check", action="store_true", help="the small version, without files")
    arguments = parser.parse_args()
    if not arguments.check and not arguments.out:
        parser.error("either --out or --check")
    study = CHECK if arguments.check else FIGURE
    try:
        heights, volume_error = simulate_all(arguments.lipofill, study)
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"figure_1: {error}", file=sys.stderr)
        return 2
    step, cell, collapse = measure(study, heights)
    for study_of in (step, cell):
        print(
            f"figure_1: {study_of.what} {study_of.sizes}: differences {study_of.differences} mm, "
            f"order {study_of.order:.2f}"
        )
    print(
        f"figure_1: volume to {volume_error:.1e}; over time x stiffness the curves differ by at most {collapse:.2e} mm"
    )
    faults = find_faults(study, heights, step, cell, volume_error)
    if not arguments.check:
        arguments.out.mkdir(parents=True, exist_ok=True)
        write_figure(study, heights, arguments.out, step, cell, "." + arguments.format)
        if arguments.page:
            write_page(arguments.page, step, cell, collapse, volume_error)
    for fault in faults:
        print(f"figure_1: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
