#!/usr/bin/env python3
"""Makes core/doc/verification.md and its plots from the files that the verification tests record
(tests/verification/record.h).

    make_page.py RECORDS_DIR PAGE IMAGES_DIR     writes the page and the plots
    make_page.py --check PAGE TESTS_DIR          exit code 1 where the page names other tests than the tree has

The same records give the same bytes.
"""

import json
import math
import pathlib
import re
import sys

SECTIONS = {
    "film": "Film alone",
    "coupled": "Film and tissue",
    "solid": "Tissue alone",
    "fat": "Fat as it is",
    "anatomy": "Anatomy",
    "planning": "Planning",
    "forecast": "Forecasts",
    "conservation": "Conservation",
}
INTRODUCTION = """# Verification

Every case has an answer that is known without the solver: a closed form, a quadrature or a similarity solution made in the test itself.
Each row is asserted by a test with the label `verification`; *reported* rows are shown without a bound. This page is made from what the
tests measured:

    deploy/verify       # builds, runs the tests, rewrites this page and its plots
"""
NAMES_HEADING = "## Tests on this page"


def natural(text):
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", text)]


def read_cases(folder):
    """Case id -> the case with the figures, series and curves of all its tests, in the order of the
    tests' names.
    """
    cases = {}
    for path in sorted(folder.glob("*.json"), key=lambda p: natural(p.name)):
        record = json.loads(path.read_text())
        case = cases.setdefault(
            record["id"],
            {
                "title": record["title"],
                "reference": record["reference"],
                "tests": [],
                "figures": [],
                "series": [],
                "curves": [],
            },
        )
        if case["title"] != record["title"]:
            sys.exit(f"make_page: {path.name}: the title of {record['id']} differs from that of another test")
        if record["reference"] not in case["reference"]:
            case["reference"] += " " + record["reference"]
        case["tests"].append(record["test"])
        for kind in ("figures", "series", "curves"):
            case[kind] += record[kind]
    return cases


def plain_name(test):
    """Suite.Name as in the source: without the instance and the parameter of a TEST_P."""
    suite, name = test.split(".", 1)
    return f"{suite.split('/')[-1]}.{name.split('/')[0]}"


def section_of(case_id):
    return case_id.split("/")[0]


def place_of(case_id):
    section = section_of(case_id)
    rank = list(SECTIONS).index(section) if section in SECTIONS else len(SECTIONS)
    return rank, section, natural(case_id)


def number(value):
    """Six digits are more than any tolerance here; what is at round-off only shows its size."""
    if value is None:
        return "not a number"
    return f"{value:.1e}" if value != 0.0 and abs(value) < 1e-9 else f"{value:.6g}"


def with_unit(value, unit):
    return number(value) if unit == "1" else f"{number(value)} {unit}"


def difference(figure):
    if figure["measured"] is None or figure["expected"] is None:
        return "-"
    gap = figure["measured"] - figure["expected"]
    if figure["bound"] == "absolute" or figure["expected"] == 0.0:
        return f"{gap:+.1e}"
    share = 100.0 * gap / abs(figure["expected"])
    return "below 1e-9 %" if abs(share) < 1e-9 else f"{share:+.2g} %"


def figure_row(figure):
    bound = figure["bound"]
    unit = figure["unit"]
    expected = with_unit(figure["expected"], unit)
    measured = with_unit(figure["measured"], unit)
    if bound == "at_most":
        return figure["quantity"], "0", measured, "", f"at most {expected}"
    if bound == "at_least":
        return figure["quantity"], "", measured, "", f"at least {expected}"
    tolerance = {
        "relative": f"{100.0 * figure['tolerance']:.3g} %",
        "absolute": with_unit(figure["tolerance"], unit),
        "reported": "reported",
    }[bound]
    return figure["quantity"], expected, measured, difference(figure), tolerance


def series_row(series):
    steps = ", ".join(
        f"{100.0 * error:.2g} % ({resolution:g})" for resolution, error in zip(series["resolutions"], series["errors"])
    )
    return (
        f"error of {series['quantity']} against {series['resolution_name']}",
        f"order {series['expected_order']:g}",
        f"order {series['observed_order']:.2f}: {steps}",
        "",
        f"at least {series['least_order']:.2g}",
    )


def table(rows):
    lines = ["| quantity | expected | measured | difference | tolerance |", "|---|---|---|---|---|"]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def summary(cases):
    lines = ["| case | reference | figures | worst share of its tolerance | observed orders |", "|---|---|---|---|---|"]
    for case_id in sorted(cases, key=place_of):
        case = cases[case_id]
        shares = [share for share in map(share_of_tolerance, case["figures"]) if share is not None]
        orders = ", ".join(describe_orders(group) for group in series_groups(case).values())
        worst = f"{100.0 * max(shares):.0f} %" if shares else ""
        count = len(case["figures"]) + len(case["series"])
        lines.append(f"| [{case['title']}](#{anchor(case_id)}) | {case['reference']} | {count} | {worst} | {orders} |")
    return "\n".join(lines)


def series_groups(case):
    """Series that belong in one plot: the same kind of refinement and the same order expected."""
    groups = {}
    for series in case["series"]:
        groups.setdefault((series["resolution_name"], series["expected_order"]), []).append(series)
    return groups


def describe_orders(group):
    observed = sorted({f"{series['observed_order']:.2f}" for series in group}, key=float)
    span = observed[0] if len(observed) == 1 else f"{observed[0]} to {observed[-1]}"
    return f"{span} ({group[0]['expected_order']:g})"


def share_of_tolerance(figure):
    """How much of what it may differ by a figure does differ; None without a tolerance."""
    measured, expected = figure["measured"], figure["expected"]
    if measured is None or figure["bound"] in ("reported", "at_least"):
        return None
    if figure["bound"] == "at_most":
        return abs(measured) / expected if expected else None
    allowed = figure["tolerance"] * (abs(expected) if figure["bound"] == "relative" else 1.0)
    return abs(measured - expected) / allowed if allowed else None


def anchor(case_id):
    return case_id.replace("/", "-")


def plot(case_id, case, folder):
    """Draws the case's series and curves side by side; returns the file's name, or None where there
    is nothing to draw.
    """
    panels = [(draw_series, group) for group in series_groups(case).values()]
    panels += [(draw_curve, curve) for curve in case["curves"]]
    if not panels:
        return None
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update(
        {
            "svg.hashsalt": "lipofill",
            "svg.fonttype": "none",
            "font.size": 9,
            "axes.grid": True,
            "grid.alpha": 0.3,
            "legend.frameon": False,
        }
    )
    import matplotlib.pyplot as plt

    columns = min(len(panels), 3)
    rows = math.ceil(len(panels) / columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.6 * columns, 2.9 * rows), squeeze=False, layout="constrained")
    for axis in axes.flat[len(panels) :]:
        axis.remove()
    for axis, (draw, what) in zip(axes.flat, panels):
        draw(axis, what)
    name = anchor(case_id) + ".svg"
    figure.savefig(folder / name, metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return name


def draw_series(axis, group):
    """Draws the errors of a group's series, and the expected slope through the last point."""
    for series in group:
        axis.loglog(
            series["resolutions"],
            [abs(error) for error in series["errors"]],
            "o-",
            markersize=4,
            linewidth=1.0,
            label=series["quantity"],
        )
    x = group[0]["resolutions"]
    power = group[0]["expected_order"] * (-1.0 if x[-1] > x[0] else 1.0)
    last = abs(group[0]["errors"][-1])
    axis.loglog(
        x,
        [last * (value / x[-1]) ** power for value in x],
        "k--",
        linewidth=0.8,
        label=f"order {group[0]['expected_order']:g}",
    )
    axis.set_xticks(x, [f"{value:.3g}" for value in x])
    axis.minorticks_off()
    axis.set_xlabel(group[0]["resolution_name"])
    axis.set_ylabel("relative error")
    if len(group) <= 6:
        axis.legend(fontsize=7)
    else:
        axis.set_title(f"{len(group)} series; dashed: order {group[0]['expected_order']:g}", fontsize=9)


def draw_curve(axis, curve):
    axis.plot(curve["x"], curve["expected"], "k-", linewidth=0.8, label=curve["expected_label"])
    axis.plot(curve["x"], curve["measured"], ".", markersize=4, label=curve["measured_label"])
    if curve["logarithmic"]:
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.xaxis.set_minor_formatter("")
    axis.set_title(curve["name"], fontsize=9)
    axis.set_xlabel(curve["x_label"])
    axis.set_ylabel(curve["y_label"])
    axis.legend()


def case_text(case_id, case, image, images_from_page):
    rows = [figure_row(figure) for figure in case["figures"]] + [series_row(series) for series in case["series"]]
    parts = [f'<a id="{anchor(case_id)}"></a>\n### {case["title"]}', case["reference"]]
    if rows:
        parts.append(table(rows))
    if image:
        parts.append(f"![{case['title']}]({images_from_page}/{image})")
    return "\n\n".join(parts)


def make_page(records, page, images):
    cases = read_cases(records)
    if not cases:
        sys.exit(f"make_page: no records in {records}")
    images.mkdir(parents=True, exist_ok=True)
    for old in images.glob("*.svg"):
        old.unlink()
    images_from_page = pathlib.PurePosixPath(images.resolve().relative_to(page.resolve().parent)).as_posix()
    parts = [INTRODUCTION.rstrip(), summary(cases)]
    last_section = None
    for case_id in sorted(cases, key=place_of):
        section = section_of(case_id)
        if section != last_section:
            parts.append(f"## {SECTIONS.get(section, section.capitalize())}")
            last_section = section
        parts.append(case_text(case_id, cases[case_id], plot(case_id, cases[case_id], images), images_from_page))
    names = sorted({plain_name(test) for case in cases.values() for test in case["tests"]})
    parts.append(NAMES_HEADING)
    parts.append("\n".join(f"- `{name}`" for name in names))
    page.write_text("\n\n".join(parts) + "\n")
    print(f"make_page: {len(cases)} cases, {len(names)} tests")


def tests_in(folder):
    """Suite.Name of every test in the sources that records a case."""
    found = set()
    for source in sorted(folder.glob("*/*_test.cc")):
        text = source.read_text()
        found |= {
            f"{suite}.{name}"
            for suite, name in re.findall(r"^TEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)", text, re.MULTILINE)
        }
    return found


def check(page, folder):
    """Names that stand on the page and in no source: the page is stale. The other way round is
    said, and no error: a test that needs what this machine lacks records nothing.
    """
    named = set(re.findall(r"^- `([\w.]+)`$", page.read_text().split(NAMES_HEADING)[-1], re.MULTILINE))
    present = tests_in(folder)
    for name in sorted(present - named):
        print(f"{page.name} does not show {name}")
    for name in sorted(named - present):
        print(f"{page.name} shows {name}, which is no test in {folder.name}: run deploy/verify")
    if not named:
        print(f"{page.name} names no tests")
    return 1 if named - present or not named else 0


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "--check":
        sys.exit(check(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])))
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    make_page(*map(pathlib.Path, sys.argv[1:]))


if __name__ == "__main__":
    main()
