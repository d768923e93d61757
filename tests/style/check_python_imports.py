#!/usr/bin/env python3
"""Checks that no module of the Python package needs itself: imports, also those for types alone,
form no circle.

Generated modules (lipofill.v1 and the like) import nothing of the package and are left out.

Exit code 1 and the circle when there is one.
"""

import ast
import pathlib
import sys

PACKAGE = "lipofill"


def modules_below(root):
    """Files by the name of their module."""
    for path in sorted((root / PACKAGE).rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


def imports_of(path, known):
    """Modules of the package that a file imports, wherever in it: at the top, for types, in a
    function.
    """
    for node in ast.walk(ast.parse(path.read_text(), str(path))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            # "from lipofill import runs" names a module, "from lipofill.runs import Run" a thing in
            # one.
            names = [f"{node.module}.{alias.name}" for alias in node.names] + [node.module or ""]
        else:
            continue
        yield from (name for name in names if name in known)


def find_circle(graph):
    """Finds one circle, depth first: its modules, the first again at its end; empty without one."""
    done = set()

    def visit(module, above):
        if module in above:
            return above[above.index(module) :] + [module]
        if module in done:
            return []
        for imported in graph[module]:
            circle = visit(imported, above + [module])
            if circle:
                return circle
        done.add(module)
        return []

    return next(filter(None, (visit(module, []) for module in graph)), [])


def main():
    files = dict(modules_below(pathlib.Path(sys.argv[1]).resolve() / "client/python"))

    graph = {name: sorted(set(imports_of(path, files)) - {name}) for name, path in files.items()}
    circle = find_circle(graph)
    if circle:
        print("these modules need each other: " + " -> ".join(circle))
        return 1
    print(f"{len(graph)} modules, no circle")
    return 0


if __name__ == "__main__":
    sys.exit(main())
