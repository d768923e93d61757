#!/usr/bin/env python3
"""Draws what `perf script` says of the steps of a simulation as a flame graph.

    flame_graph.py PERF_TEXT SVG SHARES_JSON

A box is as wide as the share of samples in which a function was on the stack, with what it called
above it; below is the call of a step. SHARES_JSON takes the inclusive share of each function. Names
are shortened: no namespaces, no template arguments. Needs nothing beyond Python.
"""

import collections
import html
import json
import pathlib
import re
import sys

ROOT = "Simulation::advance_step"
WIDTH, ROW, LEAST_WIDTH = 1200, 17, 1.5
COLOURS = {
    "geometry": "#b4a7d6",
    "solid": "#d98c5f",
    "film": "#6fa8dc",
    "coupling": "#93c47d",
    "mechanics": "#e0a3a3",
    "step": "#c9b458",
    "simulation": "#a8a05a",
    "other": "#b7b7b7",
}


def without_brackets(name, opening, closing):
    kept, depth = [], 0
    for character in name:
        depth += character == opening
        if depth == 0:
            kept.append(character)
        depth -= character == closing
    return "".join(kept)


def short_name(symbol):
    symbol = symbol.replace("(anonymous namespace)::", "").replace("operator()", "call")
    plain = without_brackets(without_brackets(symbol, "<", ">"), "(", ")")
    plain = re.sub(r"\{.*?\}", "", plain).replace(" const", "").strip()
    parts = [part for part in plain.split("::") if part]
    return "::".join(parts[-2:]) if parts else symbol


def part_of(symbol):
    match = re.match(r"(?:void )?lipofill::(geometry|solid|film|coupling|mechanics|step|simulation)::", symbol)
    return match.group(1) if match else "other"


def read_stacks(text):
    """Frames of every sample below a step, outermost first: (short name, part of the program)."""
    for sample in text.strip().split("\n\n"):
        frames = [line.split(None, 1)[1].strip() for line in sample.split("\n")[1:] if len(line.split(None, 1)) == 2]
        frames.reverse()
        named = [(short_name(symbol), part_of(symbol)) for symbol in frames if symbol != "[unknown]"]
        roots = [k for k, (name, _) in enumerate(named) if name == ROOT]
        if roots:
            yield named[roots[0] :]


class Node:
    def __init__(self):
        self.count = 0
        self.children = {}


def build_tree(stacks):
    root = Node()
    for stack in stacks:
        node = root
        node.count += 1
        for frame in stack:
            node = node.children.setdefault(frame, Node())
            node.count += 1
    return root


def depth_of(node, least_count):
    return 1 + max(
        (depth_of(child, least_count) for child in node.children.values() if child.count >= least_count), default=-1
    )


def draw(node, x, level, scale, height, boxes):
    for (name, part), child in sorted(node.children.items()):
        width = child.count * scale
        if width >= LEAST_WIDTH:
            boxes.append(box(name, part, child.count * 100.0 * scale / WIDTH, x, height - (level + 1) * ROW, width))
            draw(child, x, level + 1, scale, height, boxes)
        x += width


def box(name, part, percent, x, y, width):
    label = name if len(name) * 6.2 < width - 4 else name[: max(0, int((width - 10) / 6.2))]
    text = f'<text x="{x + 3:.1f}" y="{y + 12}">{html.escape(label)}</text>' if len(label) > 2 else ""
    return (
        f"<g><title>{html.escape(name)}: {percent:.1f} %</title>"
        f'<rect x="{x:.1f}" y="{y}" width="{max(width - 0.5, 0.5):.1f}" '
        f'height="{ROW - 1}" rx="1" fill="{COLOURS[part]}"/>{text}</g>'
    )


def make_svg(root):
    height = (depth_of(root, LEAST_WIDTH * root.count / WIDTH) + 2) * ROW
    boxes = []
    draw(root, 0.0, 0, WIDTH / root.count, height - ROW, boxes)
    legend = "".join(
        f'<rect x="{10 + 120 * k}" y="{height - ROW + 3}" width="12" height="12" fill="{colour}"/>'
        f'<text x="{27 + 120 * k}" y="{height - ROW + 13}">{part}</text>'
        for k, (part, colour) in enumerate(COLOURS.items())
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'font-family="monospace" font-size="10">\n'
        + f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>\n'
        + "\n".join(boxes)
        + "\n"
        + legend
        + "\n</svg>\n"
    )


def inclusive_shares(stacks):
    counts = collections.Counter()
    for stack in stacks:
        counts.update(set(stack))
    return [
        {"function": name, "part": part, "share": count / len(stacks)}
        for (name, part), count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    ]


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    source, svg, shares = map(pathlib.Path, sys.argv[1:])
    stacks = list(read_stacks(source.read_text(errors="replace")))
    if not stacks:
        sys.exit(f"flame_graph: no sample in {source} has {ROOT} on its stack")
    svg.write_text(make_svg(build_tree(stacks)))
    shares.write_text(json.dumps({"samples": len(stacks), "functions": inclusive_shares(stacks)}, indent=1) + "\n")
    print(f"flame_graph: {len(stacks)} samples")


if __name__ == "__main__":
    main()
