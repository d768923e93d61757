#!/usr/bin/env python3
"""Checks that includes follow the layout: dependencies between folders point one way.

    core/base <- geometry <- {solid, film, anatomy} <- coupling <- model <- plan <- mechanics <- step <- simulation <- export,
    then server on core and proto, client on proto alone; in the server only wire, entry, backend, patients, simulations
    and frames see both proto and core; core sees neither gRPC nor Protobuf.

Exit code 1 and a line a breach when they do not.
"""

import pathlib
import re
import sys

BELOW_MODEL = {"core/base", "core/geometry", "core/anatomy", "core/solid", "core/film", "core/coupling"}
ALLOWED = {
    "core/base": {"core/base"},
    "core/geometry": {"core/base", "core/geometry"},
    "core/anatomy": {"core/base", "core/geometry", "core/anatomy"},
    "core/solid": {"core/base", "core/geometry", "core/solid"},
    "core/film": {"core/base", "core/geometry", "core/film"},
    "core/coupling": {"core/base", "core/geometry", "core/solid", "core/film", "core/coupling"},
    "core/model": BELOW_MODEL | {"core/model"},
    "core/plan": BELOW_MODEL | {"core/model", "core/plan"},
    "core/mechanics": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics"},
    "core/step": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics", "core/step"},
    "core/simulation": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics", "core/step", "core/simulation"},
    "core/export": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics", "core/simulation", "core/export"},
    "server/store": {"core/base", "server/store"},
    "server/security": {"core/base", "server/store", "server/security"},
    "server/ops": {"core/base", "server/security", "server/ops"},
    "server/sessions": {"core", "server/store", "server/sessions"},
    "server/wire": {"core", "proto", "grpc", "server"},
    "server/entry": {"core", "proto", "grpc", "server"},
    "server/backend": {"core", "proto", "grpc", "server"},
    "server/patients": {"core", "proto", "grpc", "server"},
    "server/simulations": {"core", "proto", "grpc", "server"},
    "server/frames": {"core", "proto", "grpc", "server"},
    "server": {"core/base", "core/coupling", "server"},
    "client": {"proto", "grpc", "client"},
}


def folder_of(path, names):
    """Longest of `names` that is a folder above the path."""
    above = [name for name in names if path == name or path.startswith(name + "/")]
    return max(above, key=len) if above else None


def target_of(include):
    if re.search(r"\.pb\.h$", include):
        return "proto"
    if re.match(r"(grpc|grpcpp|grpc\+\+)/", include):
        return "grpc"
    if include.startswith("google/protobuf/"):
        return "proto"
    if re.match(r"(core|server|client|tests)/", include):
        return str(pathlib.PurePosixPath(include).parent)
    return None


def breaches(root):
    for source in sorted(root.glob("core/**/*")) + sorted(root.glob("server/**/*")) + sorted(root.glob("client/**/*")):
        if source.suffix not in {".h", ".cc"}:
            continue
        path = source.relative_to(root).as_posix()
        folder = folder_of(path, ALLOWED)
        if folder is None:
            yield f"{path}: in no folder of the layout"
            continue
        for number, line in enumerate(source.read_text().splitlines(), 1):
            match = re.match(r'\s*#include\s+["<]([^">]+)[">]', line)
            target = target_of(match.group(1)) if match else None
            if target and folder_of(target, ALLOWED[folder]) is None:
                yield f"{path}:{number}: {folder} must not include {match.group(1)}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    found = list(breaches(root))
    print("\n".join(found) or "every include follows the layout")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
