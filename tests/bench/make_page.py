#!/usr/bin/env python3
"""Makes core/doc/performance.md from what the benchmarks measured; `deploy/bench --page` calls it.

    make_page.py BENCH_JSON PAGE [--micro JSON] [--service JSON] [--shares JSON --flame SVG]
    make_page.py --check BENCH_JSON                exit code 1 where the page would lack figures

BENCH_JSON is of lipofill_bench, --micro of lipofill_microbench, --service of
lipofill_service_bench, --shares and --flame of flame_graph.py. What is not given is left out of the
page. The same files give the same bytes.
"""

import argparse
import json
import math
import os
import pathlib
import sys

KEYS = (
    "step_ms_mean",
    "step_ms_p99",
    "paper_way_step_ms",
    "floor_ms",
    "ratio_to_floor",
    "speedup_vs_paper_way",
    "growth_4x",
    "growth_16x",
    "settle_wall_s",
    "settle_fast_wall_s",
    "session_mb",
    "state_hash",
    "scales",
    "bounds",
    "machine",
    "rounds",
    "settled",
    "injecting_steps",
)
PHASES = ("step", "frame", "encoding")
PARTS = ("element", "factor", "solve", "film", "coupling")
INTRODUCTION = """# Performance

Time steps of the sample plan `jaw_angle`, which is of the paper's size, and of the same face with 4, 16 and 64 times the hexahedra and film cells; the ways
there are to solve a step; the settled shape; a running daemon. Simulations run on one core, everything compared runs in one process and in turn. Times are
processor time of the working thread, so that ratios hold on a busy machine; wall time is named as such. This page is made from one run of

    deploy/bench --page     # measures, rewrites this page; deploy/bench alone prints the first tables in under eight minutes
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


def name_of(scale):
    return f"{scale['scale']:g}x"


def title_of(scale):
    return (
        f"### {name_of(scale)}: {scale['hexahedra']:,} hexahedra, {scale['unknowns']:,} unknowns, "
        f"{scale['film_cells']:,} film cells"
    )


def bounds_table(bench):
    rows = []
    for bound in bench["bounds"]:
        verdict = {True: "met", False: "**not met**", None: "not measured"}[bound["met"]]
        sign = "at most" if bound["at_most"] else "at least"
        rows.append((bound["name"], number(bench[bound["key"]]), f"{sign} {number(bound['bound'])}", verdict))
    return table(("", "measured", "bound", ""), rows)


def samples_row(name, samples):
    return (name, *(number(samples[key]) for key in ("median_ms", "mean_ms", "p99_ms", "worst_ms")))


def step_table(step, parts, more=()):
    rows = [samples_row("**step**", step)]
    rows += [samples_row("of it, " + name, samples) for name, samples in parts["times"].items()]
    rows += [samples_row(name, samples) for name, samples in more]
    return table(("ms", "median", "mean", "p99", "worst"), rows)


def counts(parts):
    return (
        "A step has, in the mean, "
        + ", ".join(f"{number(count)} {name.replace('_', ' ')}" for name, count in parts["per_step"].items())
        + "."
    )


def step_parts(bench):
    injecting = bench["injecting_steps"]
    yield "## A step"
    yield f"All {number(injecting['step']['samples'])} steps of the plan's 10 ms while fat flows in, at the paper's size:"
    yield step_table(injecting["step"], injecting["parts"])
    yield counts(injecting["parts"])
    yield "At every size, 10 ms each, from the midst of filling the first zone on; *frame*: of the skin and the film, as viewers see by default:"
    for scale in bench["scales"]:
        phases = scale["steps"]["phases"]
        more = [(name.replace("_", " "), samples) for name, samples in phases.items() if name != "step"]
        yield title_of(scale)
        yield step_table(phases["step"], scale["steps"]["parts"], more)
        yield counts(scale["steps"]["parts"])


def routes_table(scale):
    rows = []
    for route in scale["routes"]:
        name = f"{route['name']}: {route['what']}"
        if route["total"] is None:
            rows.append((name, "-", "-", "-", "-", "-"))
            continue
        rows.append(
            (
                name,
                number(route["total"]["median_ms"]) + ("" if route["is_complete"] else " *"),
                number(route["phases"]["factor"]["median_ms"]),
                number(route["analysis_ms"]),
                str(route["iterations"] or "direct"),
                number(route["relative_difference"]),
            )
        )
    return table(("ms", "all", "of it, factor", "analysis, once", "iterations", "difference"), rows)


def route_parts(bench):
    yield "## Ways to solve a step"
    yield (
        "One linear step from the matrices of the run, S and B of its deformed state. *Difference*: of the answer, pressure or displacement, from a "
        "reference corrected in extended precision. A star: C is extrapolated from 256 of its columns. The floor is the element work and the fastest "
        "library's factor and one solve in double precision; a step of a simulation is below it where one factor serves many steps."
    )
    for scale in bench["scales"]:
        if not scale["routes"]:
            continue
        yield title_of(scale)
        yield routes_table(scale)
        yield (
            f"Element work {number(scale['element_work']['median_ms'])} ms, floor {number(scale['floor_ms'])} ms, the paper's way "
            f"{number(scale['paper_way_step_ms'])} ms, mean step of the simulation {number(mean_step(scale))} ms."
        )


def mean_step(scale):
    return scale["steps"]["phases"]["step"]["mean_ms"]


def part_ms(scale, part, of=None):
    """Mean time of a part of a step, or of one of what it does."""
    parts = scale["steps"]["parts"]
    mean = parts["times"][part]["mean_ms"]
    if of is None:
        return mean
    return mean / parts["per_step"][of] if parts["per_step"][of] else None


def growth_parts(bench):
    first = bench["scales"][0]
    columns = (("element", None), ("factor", "factorisations"), ("solve", "tissue_solves"), ("film", None))
    rows = []
    for scale in bench["scales"]:
        row = [name_of(scale), number(mean_step(scale)), number(mean_step(scale) / mean_step(first))]
        for part, of in columns:
            here, there = part_ms(scale, part, of), part_ms(first, part, of)
            row.append(number(here / there) if here and there else "-")
        rows.append((*row, number(scale["peak_rss_mb"])))
    laws = []
    for scale in bench["scales"]:
        n = scale["hexahedra"] / first["hexahedra"]
        log = 1.0 + math.log(n) / math.log(first["unknowns"])
        laws.append((name_of(scale), "", "", number(n), number(n**1.5), number(n * log), number(n), ""))
    yield "## Growth"
    yield "Over the first size; *factor*: of one factorisation, *solve*: of one pair of half solves."
    yield table(("", "mean step [ms]", "step", "element", "factor", "solve", "film", "memory at the most [MB]"), rows)
    yield "The direct solver's law in the plane, N for elements and film cells, N^1.5 for the factor, N log N for a solve:"
    yield table(("", "", "", "element", "factor", "solve", "film", ""), laws)


def settled_parts(bench):
    rows = [
        (
            name.replace("_", " "),
            number(run["wall_s"]),
            number(run["cpu_s"]),
            number(run["steps"]),
            number(run["simulated_s"]),
            number(run["skin_max_displacement_mm"], 4),
            f"`{run['state_hash'][:16]}`",
        )
        for name, run in bench["settled"].items()
    ]
    yield "## To the settled shape"
    yield "From the first step on, by the plan's own steps and with the goal SETTLED_SHAPE (`lipofill run --fast`)."
    yield table(("", "wall [s]", "processor [s]", "steps", "simulated [s]", "largest displacement [mm]", "state"), rows)
    yield f"A session at the paper's size takes {number(bench['session_mb'])} MB, the mean over {bench['sessions_for_memory']} of the same model."


def flame_parts(shares, image):
    yield "## Where the time goes"
    yield (
        "Samples of the stack during all steps of the plan, by `perf`: the wider a box, the larger the share of time in it and in what it calls, which "
        "lies above it."
    )
    if image:
        yield f"![Flame graph of a step]({image})"
    rows = [
        (f"`{entry['function']}`", entry["part"], f"{100.0 * entry['share']:.1f} %")
        for entry in shares["functions"]
        if entry["share"] >= 0.03 and entry["part"] != "other"
    ]
    yield f"Functions of the model with 3 % or more of {number(shares['samples'])} samples, what they call included:"
    yield table(("", "part", "share"), rows)


def micro_parts(micro):
    unit = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
    groups = {}
    for run in micro["benchmarks"]:
        name, _, size = run["name"].partition("/")
        if size and not size.isdigit():
            suffix, _, size = size.partition("/")
            name = f"{name} ({suffix})"
        groups.setdefault(name, {})[size or "1"] = run
    rows = []
    for name, runs in sorted(groups.items()):
        row = [name.replace("_", " ")]
        for size in ("1", "4", "16"):
            run = runs.get(size)
            row += (
                [number(run["cpu_time"] * unit[run["time_unit"]]), number(run["items_per_second"] / 1e6)]
                if run
                else ["-", "-"]
            )
        rows.append(tuple(row))
    yield "## Parts one by one"
    yield (
        "Google Benchmark, `lipofill_microbench`: milliseconds, and millions of items a second, which are hexahedra, film cells, unknowns, triangles or frames. "
        "Work that is linear in its size keeps its rate."
    )
    yield table(("", "1x ms", "M/s", "4x ms", "M/s", "16x ms", "M/s"), rows)


def service_parts(service):
    yield "## A running daemon"
    if "sessions" in service:
        yield "Sessions of one model at once:"
        yield table(
            ("sessions", "workers", "steps/s", "fairness", "processor ms a step", "threads", "MB a session"),
            [
                (
                    number(row["sessions"]),
                    number(row["workers"]),
                    number(row["steps_per_s"]),
                    number(row["fairness"]),
                    number(row["worker_cpu_ms_per_step"]),
                    number(row["threads"]),
                    number(row["running_mb_per_session"]),
                )
                for row in service["sessions"]
            ],
        )
    if "viewers" in service:
        yield "Viewers of one simulation; *processor* of its worker, *transport* of the threads that send:"
        yield table(
            ("viewers", "steps/s", "processor ms a step", "of the first row", "transport ms a step"),
            [
                (
                    number(row["viewers"]),
                    number(row["steps_per_s"]),
                    number(row["worker_cpu_ms_per_step"]),
                    number(row["worker_cpu_of_first_row"]),
                    number(row["transport_cpu_ms_per_step"]),
                )
                for row in service["viewers"]
            ],
        )
    for startup in service.get("startup", []):
        yield f"From the scan's file to the first frame, `{startup['scan']}`, {number(startup['served']['triangles'])} triangles:"
        yield table(
            ("", "wall ms", "processor ms"),
            [
                (phase["phase"], number(phase["wall_ms"]), number(phase["cpu_ms"]))
                for phase in startup["served"]["phases"]
            ]
            + [("**first frame**", number(startup["served"]["first_frame_ms"]), "")],
        )


def sections(bench, micro=None, service=None, shares=None, image=None):
    machine = bench["machine"]
    yield INTRODUCTION.rstrip()
    yield f"This run: {machine['processor']}, {machine['cores']} cores, {bench['rounds']} rounds; final state of the plan `{bench['state_hash']}`."
    yield "## What is reached"
    yield bounds_table(bench)
    yield from step_parts(bench)
    if shares:
        yield from flame_parts(shares, image)
    yield from route_parts(bench)
    yield from growth_parts(bench)
    yield from settled_parts(bench)
    if service:
        yield from service_parts(service)
    if micro:
        yield from micro_parts(micro)


def missing_figures(bench):
    missing = [key for key in KEYS if key not in bench]
    for scale in bench.get("scales", []):
        missing += [f"{name_of(scale)} {phase}" for phase in PHASES if phase not in scale["steps"]["phases"]]
        missing += [f"{name_of(scale)} {part}" for part in PARTS if part not in scale["steps"]["parts"]["times"]]
        missing += [
            f"{name_of(scale)} {route['name']}, whose library is there"
            for route in scale["routes"]
            if route["total"] is None and scale["scale"] < 1 and not route["what"].startswith("not measured")
        ]
    return missing


def read(path):
    return json.loads(path.read_text()) if path else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="only look whether all figures are there")
    parser.add_argument("bench", type=pathlib.Path)
    parser.add_argument("page", type=pathlib.Path, nargs="?")
    for option in ("--micro", "--service", "--shares", "--flame"):
        parser.add_argument(option, type=pathlib.Path)
    arguments = parser.parse_args()
    bench = read(arguments.bench)
    missing = missing_figures(bench)
    if missing:
        sys.exit(f"make_page: missing in {arguments.bench.name}: " + ", ".join(missing))
    image = os.path.relpath(arguments.flame, arguments.page.parent) if arguments.flame else None
    parts = list(sections(bench, read(arguments.micro), read(arguments.service), read(arguments.shares), image))
    if not arguments.check:
        arguments.page.write_text("\n\n".join(parts) + "\n")
    print(f"make_page: {len(parts)} parts")


if __name__ == "__main__":
    main()
