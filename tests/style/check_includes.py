#!/usr/bin/env python3
"""Checks that includes follow the layout: dependencies between folders point one way.

    tests/style/check_includes.py ROOT

    core/base <- geometry <- {solid, film, anatomy} <- coupling <- model <- plan <- mechanics
    <- {step, equilibrium} <- simulation <- {planning, forecast, export}

Then come server on core and proto, and client on proto alone; core sees neither gRPC nor Protobuf.

    store <- {sessions, security} <- wire <- backend <- entry
    <- {patients, simulations, planning, frames} <- main.cc and grpc_server, which registers the services
    security <- ops <- backend

In the server the services do not see each other, and the door (connections, before gRPC has them)
sees no other folder. wire turns messages into what core takes, and
back; gRPC is for entry and above, of it wire knows the status alone. Headers that only some may
include are RESERVED. It prints file:line for every include that goes another way.
"""

import pathlib
import re

from style import check

BELOW_MODEL = {"core/base", "core/geometry", "core/anatomy", "core/solid", "core/film", "core/coupling"}
RECORDS = {"server/store", "server/sessions", "server/security"}
BELOW_BACKEND = RECORDS | {"server/ops", "server/wire"}
BELOW_ENTRY = BELOW_BACKEND | {"server/backend"}
BELOW_SERVICES = BELOW_ENTRY | {"server/entry"}
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
    "core/equilibrium": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics", "core/equilibrium"},
    "core/simulation": BELOW_MODEL
    | {"core/model", "core/plan", "core/mechanics", "core/step", "core/equilibrium", "core/simulation"},
    "core/export": BELOW_MODEL | {"core/model", "core/plan", "core/mechanics", "core/simulation", "core/export"},
    "core/planning": BELOW_MODEL
    | {"core/model", "core/plan", "core/mechanics", "core/step", "core/equilibrium", "core/simulation"}
    | {"core/planning"},
    "core/forecast": BELOW_MODEL
    | {"core/model", "core/plan", "core/mechanics", "core/step", "core/equilibrium", "core/simulation"}
    | {"core/forecast"},
    "server/store": {"core/base", "server/store"},
    "server/security": {"core/base", "server/store", "server/security"},
    "server/door": {"core/base", "server/door"},
    "server/ops": {"core/base", "server/door", "server/security", "server/store", "server/ops"},
    "server/sessions": {"core", "server/store", "server/sessions"},
    "server/wire": RECORDS
    | {"core/base", "core/geometry", "core/anatomy", "core/model", "core/plan", "core/simulation", "core/planning"}
    | {"core/forecast", "proto", "grpc", "server/wire"},
    "server/backend": BELOW_BACKEND
    | {"core/base", "core/geometry", "core/model", "core/simulation", "core/planning"}
    | {"proto", "server/backend"},
    "server/entry": BELOW_ENTRY | {"core/base", "server/door"} | {"proto", "grpc", "server/entry"},
    "server/patients": BELOW_SERVICES
    | {"core/base", "core/geometry", "core/model"}
    | {"proto", "grpc", "server/patients"},
    "server/simulations": BELOW_SERVICES | {"core/base", "core/export"} | {"proto", "grpc", "server/simulations"},
    "server/planning": BELOW_SERVICES
    | {"core/base", "core/geometry", "core/model", "core/planning", "core/forecast"}
    | {"proto", "grpc", "server/planning"},
    "server/frames": BELOW_SERVICES | {"core/base"} | {"proto", "grpc", "server/frames"},
    "server": {"core/base", "core/coupling", "grpc", "server"},
    "client": {"proto", "grpc", "client"},
}

# Headers that only these may include, tests too: paths, or folders with all below them.
RESERVED = {
    # Everyone else knows the store by its interface, store.h. The chaos test opens what a killed
    # daemon left.
    "server/store/sql_store.h": {
        "server/store",
        "server/main.cc",
        "tests/unit/server/store",
        "tests/integration/chaos",
    },
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


def includes_of(source):
    for number, line in enumerate(source.read_text().splitlines(), 1):
        match = re.match(r'\s*#include\s+["<]([^">]+)[">]', line)
        if match:
            yield number, match.group(1)


def sources_below(root, *parts):
    for part in parts:
        for source in sorted((root / part).glob("**/*")):
            if source.suffix in {".h", ".cc"}:
                yield source.relative_to(root).as_posix(), source


def breaches(root):
    for path, source in sources_below(root, "core", "server", "client"):
        folder = folder_of(path, ALLOWED)
        if folder is None:
            yield f"{path}: in no folder of the layout"
            continue
        for number, included in includes_of(source):
            target = target_of(included)
            if target and folder_of(target, ALLOWED[folder]) is None:
                yield f"{path}:{number}: {folder} must not include {included}"
    for path, source in sources_below(root, "core", "server", "client", "tests"):
        for number, included in includes_of(source):
            if included in RESERVED and folder_of(path, RESERVED[included]) is None:
                yield f"{path}:{number}: {included} is not for it, see RESERVED"


if __name__ == "__main__":
    check(breaches, "every include follows the layout")
