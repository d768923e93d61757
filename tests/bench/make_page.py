#!/usr/bin/env python3
"""Makes core/doc/performance.md from what lipofill_bench and lipofill_microbench measured.

    make_page.py BENCH_JSON PAGE [--micro MICRO_JSON] [--flame SVG]    writes the page
    make_page.py --check BENCH_JSON                                    exit code 1 where the page would lack figures

The same files give the same bytes.
"""

import argparse
import json
import math
import pathlib
import sys

KEYS = ("step_ms_mean", "step_ms_p99", "paper_way_step_ms", "floor_ms", "ratio_to_floor", "speedup_vs_paper_way", "growth_4x",
        "growth_16x", "settle_wall_s", "session_mb", "state_hash", "scales", "bounds", "machine", "rounds", "settled")
INTRODUCTION = """# Performance

Time steps of the sample plan `jaw_angle` (the paper's size) and of the same face with 4, 16 and more times the hexahedra and film cells, and the
ways there are to solve one. Everything runs in one process and in turn, on one core. Times are processor time of the working thread, so that ratios hold
on a busy machine; wall time is named as such. This page is made from the figures of one run:

    deploy/bench --page             # measures, rewrites this page
    deploy/bench --page --scale 1 --scale 4 --scale 16 --scale 64    # with 64 times the hexahedra, beyond eight minutes
"""


def number(value, digits=3):
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    if value == 0:
        return "0"
    if isinstance(value, int):
        return f"{value:,}"
    magnitude = math.floor(math.log10(abs(value)))
    if magnitude >= digits - 1:
        return f"{round(value):,}"
    return f"{value:.{digits - 1 - magnitude}f}" if magnitude >= -3 else f"{value:.1e}"


def table(titles, rows):
    lines = ["| " + " | ".join(titles) + " |", "|---|" + "---:|" * (len(titles) - 1)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def title_of(scale):
    return (f"### {scale['scale']}x: {scale['hexahedra']:,} hexahedra, {scale['unknowns']:,} unknowns, "
            f"{scale['film_cells']:,} film cells")


def bounds_table(bench):
    rows = []
    for bound in bench["bounds"]:
        verdict = {True: "met", False: "**not met**", None: "not measured"}[bound["met"]]
        sign = "at most" if bound["at_most"] else "at least"
        rows.append((bound["name"], number(bench[bound["key"]]), f"{sign} {number(bound['bound'])}", verdict))
    return table(("", "measured", "bound", ""), rows)


def phases_table(scale):
    rows = [(name, *(number(samples[key]) for key in ("median_ms", "mean_ms", "p99_ms", "worst_ms")))
            for name, samples in scale["steps"]["phases"].items()]
    return table(("ms", "median", "mean", "p99", "worst"), rows)


def routes_table(scale):
    rows = []
    for route in scale["routes"]:
        if route["total"] is None:
            rows.append((f"{route['name']}: {route['what']}", "-", "-", "-", "-", "-"))
            continue
        sampled = "" if route["is_complete"] else " *"
        rows.append((f"{route['name']}: {route['what']}", number(route["total"]["median_ms"]) + sampled,
                     number(route["phases"]["factor"]["median_ms"]), number(route["analysis_ms"]),
                     str(route["iterations"] or "direct"), number(route["relative_difference"])))
    return table(("ms", "all", "of it, factor", "analysis, once", "iterations", "difference"), rows)


def growth_table(bench):
    first = bench["scales"][0]
    rows = []
    for scale in bench["scales"]:
        factor = scale["hexahedra"] / first["hexahedra"]
        step = scale["steps"]["phases"]["step"]["mean_ms"]
        rows.append((f"{scale['scale']}x", number(scale["hexahedra"]), number(scale["film_cells"]), number(step),
                     number(step / first["steps"]["phases"]["step"]["mean_ms"]), number(factor ** 1.5),
                     number(scale["peak_rss_mb"])))
    return table(("", "hexahedra", "film cells", "mean step [ms]", "over 1x", "N^1.5", "peak memory [MB]"), rows)


def settled_table(bench):
    rows = [(name.replace("_", " "), number(run["wall_s"]), number(run["cpu_s"]), number(run["steps"]), number(run["simulated_s"]),
             number(run["skin_max_displacement_mm"], 4), f"`{run['state_hash'][:16]}`")
            for name, run in bench["settled"].items()]
    return table(("", "wall [s]", "processor [s]", "steps", "simulated [s]", "largest displacement [mm]", "state"), rows)


def sections(bench):
    machine = bench["machine"]
    yield INTRODUCTION.rstrip()
    yield f"This run: {machine['processor']}, {machine['cores']} cores, {bench['rounds']} rounds; state `{bench['state_hash']}`."
    yield "## What is reached"
    yield bounds_table(bench)
    yield "## A step"
    for scale in bench["scales"]:
        yield title_of(scale)
        yield phases_table(scale)
    yield "## Ways to solve a step"
    yield ("One linear step of the same matrices, S and B of a deformed state. *Difference*: of the answer, pressure or displacement, from a "
           "reference corrected in extended precision. A star: C is extrapolated from 1,000 of its columns.")
    for scale in bench["scales"]:
        if not scale["routes"]:
            continue
        yield title_of(scale)
        yield routes_table(scale)
        yield (f"Floor (element work {number(scale['element_work']['median_ms'])} ms, the fastest library's factor and one solve): "
               f"{number(scale['floor_ms'])} ms. The paper's way with element work: {number(scale['paper_way_step_ms'])} ms.")
    yield "## Growth"
    yield growth_table(bench)
    yield "## To the settled shape"
    yield settled_table(bench)
    yield "## Memory"
    yield f"A session at 1x: {number(bench['session_mb'])} MB, the mean over {bench['sessions_for_memory']} of the same model."


def missing_keys(bench):
    missing = [key for key in KEYS if key not in bench]
    for scale in bench.get("scales", []):
        missing += [f"scales[{scale['scale']}].steps.phases.{phase}" for phase in ("step", "frame", "encoding")
                    if phase not in scale["steps"]["phases"]]
        missing += [f"{route['name']} was not measured, and its library is there" for route in scale["routes"]
                    if route["total"] is None and scale["scale"] < 1 and not route["what"].startswith("not measured")]
    return missing


def check(path):
    bench = json.loads(path.read_text())
    missing = missing_keys(bench)
    if missing:
        sys.exit("make_page: missing in " + path.name + ": " + ", ".join(missing))
    print(f"make_page: {len(list(sections(bench)))} parts, all figures are there")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="only look whether all figures are there")
    parser.add_argument("bench", type=pathlib.Path)
    parser.add_argument("page", type=pathlib.Path, nargs="?")
    arguments = parser.parse_args()
    if arguments.check or arguments.page is None:
        return check(arguments.bench)
    parts = list(sections(json.loads(arguments.bench.read_text())))
    arguments.page.write_text("\n\n".join(parts) + "\n")
    print(f"make_page: {arguments.page}")
    return None


if __name__ == "__main__":
    main()
