#!/usr/bin/env python3
"""Makes core/doc/credibility.md: what speaks for the model's figures and what does not, after the
eight categories of evidence of the FDA's guidance on computational modelling (November 2023).

    make_page.py            writes the page
    make_page.py --check    exit code 1 where the page is not what would be written

What was verified comes from core/doc/verification.md, and what was measured against published
figures from core/doc/credibility.json (tests/credibility/measure.py). What forecasts were held
against comes from core/doc/forecasts.json (deploy/forecasts). The words are in evidence.py.
"""

import json
import pathlib
import re
import sys
import textwrap

import evidence

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "core/doc/credibility.md"
VERIFICATION = ROOT / "core/doc/verification.md"
MEASURED = ROOT / "core/doc/credibility.json"
FORECASTS = ROOT / "core/doc/forecasts.json"
WIDTH = 120


def wrap(text):
    """A paragraph or a list that is written in lines of any length."""
    lines = []
    for item in re.split(r"\n\s*(?=- )", text.strip()):
        indent = "  " if item.startswith("- ") else ""
        joined = " ".join(item.split())
        lines += textwrap.wrap(
            joined, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
        )
    return "\n".join(lines)


def table(columns, rows):
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def verified():
    """Each section of the verification page: its name, how many cases and figures it has, and what
    share of its tolerance the worst figure uses.
    """
    text = VERIFICATION.read_text()
    rows = re.findall(r"^\| \[(.+?)\]\(#([\w-]+)\) \| .* \| (\d+) \| (?:(\d+) %)? ?\| .*\|$", text, re.MULTILINE)
    headings = re.findall(r'^## (.+?)$|^<a id="([\w-]+)"></a>$', text, re.MULTILINE)
    section_of, section = {}, ""
    for heading, anchor in headings:
        if heading:
            section = heading
        else:
            section_of[anchor] = section
    sums = {}
    for _, anchor, figures, worst in rows:
        cases, total, most = sums.get(section_of[anchor], (0, 0, 0))
        sums[section_of[anchor]] = (cases + 1, total + int(figures), max(most, int(worst or 0)))
    return sums


def verification_table():
    return table(
        ("part", "cases", "figures", "worst share of its tolerance"),
        [(name, str(cases), str(figures), f"{worst} %") for name, (cases, figures, worst) in verified().items()],
    )


def case(anchor):
    """A link to a case of the verification page, which has to be there."""
    text = VERIFICATION.read_text()
    found = re.search(rf"^\| \[(.+?)\]\(#{re.escape(anchor)}\)", text, re.MULTILINE)
    if not found:
        sys.exit(f"make_page: {VERIFICATION.name} has no case {anchor}")
    return f"[{found[1]}](verification.md#{anchor})"


def runs(measured, regions, planes=None):
    return [
        run for run in measured["runs"] if run["region"] in regions and (planes is None or run["plane"] in planes)
    ]


def span(values):
    """The middle value, and the range where there are several."""
    ordered = sorted(values)
    if not ordered:
        return "did not come to rest"
    middle = ordered[len(ordered) // 2] if len(ordered) % 2 else sum(ordered[len(ordered) // 2 - 1 :][:2]) / 2
    return f"{middle:.2f}" if len(ordered) == 1 else f"{middle:.2f} ({ordered[0]:.2f}-{ordered[-1]:.2f})"


def coefficients(some):
    return [run["coefficient"] for run in some if "coefficient" in run]


def cadaver_table(measured):
    rows = []
    for where, region, plane, published in evidence.CADAVER:
        found = coefficients(runs(measured, (region,), (plane,)))
        gap = f"{sorted(found)[len(found) // 2] - published:+.2f}" if found else ""
        rows.append((where, f"`{region}`, below {plane}", f"{published:.2f}", span(found), gap))
    return table(("compartment", "here", "cadaver", "simulated: median (range)", "difference"), rows)


def plane_table(measured):
    regions = list(dict.fromkeys(run["region"] for run in measured["runs"]))
    planes = ("skin", "subcutaneous", "smas", "muscle")
    rows = []
    for region in regions:
        cells = [runs(measured, (region,), (plane,)) for plane in planes]
        rows.append((f"`{region}`", *(span(coefficients(some)) if some else "" for some in cells)))
    return table(("region", *(f"below {plane}" for plane in planes)), rows)


def filler_table(measured):
    rows = []
    for where, regions, published in evidence.FILLERS:
        found = coefficients([run for run in runs(measured, regions) if run["face"] == evidence.OWN_FACE])
        rows.append((where, published, span(found)))
    return table(("where", "skin gained over what was injected, published", "simulated: median (range)"), rows)


def index_table(forecasts):
    rows = [
        (
            index["figure"],
            f"{index['largest_difference_first']:.3f}",
            f"{index['largest_difference_total']:.3f}",
            f"{index['standard_error_of_reference']:.3f}",
        )
        for index in forecasts["indices"]
    ]
    return table(
        ("figure", "first index: largest difference", "total index: largest difference", "standard error of the runs"),
        rows,
    )


def interval_table(forecasts):
    fresh, reference = forecasts["coverage"], forecasts["coverage_of_reference"]
    rows = [
        (name, f"{100.0 * fresh[key]:.1f} %", f"{100.0 * reference[key]:.1f} %") for name, key in evidence.INTERVALS
    ]
    return table(("figure", f"{fresh['cases']} fresh cases", f"{reference['cases']:,} cases of the runs"), rows)


def faces_of(measured):
    return len({run["face"] for run in measured["runs"]})


def unsettled(measured):
    failed = [run for run in measured["runs"] if "coefficient" not in run]
    if not failed:
        return "All came to rest."
    names = ", ".join(f"`{run['region']}` below {run['plane']} on {run['face']}" for run in failed)
    return f"{len(failed)} did not come to rest, and are left out: {names}."


def page():
    measured = json.loads(MEASURED.read_text())
    forecasts = json.loads(FORECASTS.read_text())
    fill = {
        "verification_table": verification_table(),
        "cadaver_table": cadaver_table(measured),
        "plane_table": plane_table(measured),
        "filler_table": filler_table(measured),
        "index_table": index_table(forecasts),
        "interval_table": interval_table(forecasts),
        "assumed_table": table(("what", "figure", "why, and how it is varied"), evidence.ASSUMED),
        "accuracy_table": table(("work", "accuracy"), evidence.OTHERS),
    }
    counts = {
        "runs": len(measured["runs"]),
        "faces": faces_of(measured),
        "unsettled": unsettled(measured),
        "members": f"{forecasts['members']:,}",
        "reference_runs": f"{forecasts['reference_runs']:,}",
    }
    parts = []
    for part in evidence.PARTS:
        if part in fill:
            parts.append(fill[part])
        elif part.startswith("#"):
            parts.append(part)
        else:
            parts.append(wrap(re.sub(r"\{case:([\w-]+)\}", lambda m: case(m[1]), part).format(**counts)))
    return "\n\n".join(parts) + "\n"


def main():
    if sys.argv[1:] == ["--check"]:
        if PAGE.read_text() != page():
            sys.exit(f"{PAGE.name} is not what its generator writes: run tests/credibility/make_page.py")
        print(f"{PAGE.name} is what its generator writes")
    elif not sys.argv[1:]:
        PAGE.write_text(page())
        print(f"make_page: {PAGE.name}")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
