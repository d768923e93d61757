#!/usr/bin/env python3
"""Checks the npm packages that the page, its gateway and the schema's linter are built from.

    tests/web/check_packages.py ROOT            compares the locks with the list, without a network
    tests/web/check_packages.py ROOT --write    writes the list anew; whoever commits it has looked

client/web/packages.allow names every package that somebody has looked at: its use (page: its code
is in what users run; build: it makes or tests that), name, version, licence and SHA-512. A lock
that has another, from another registry, with a script that runs when it is installed, or under a
licence that does not go with the project's own, fails; so does what is installed and is not in the
lock. The list of a package nobody needs any more fails too.
"""

import json
import pathlib
import sys

LOCKS = ("client/web/package-lock.json", "tests/api/package-lock.json")
# Where deploy/setup installs them: npm's own record of what it put there.
INSTALLED = ("build/web/node_modules/.package-lock.json", "build/api-tools/node_modules/.package-lock.json")
LIST = "client/web/packages.allow"
REGISTRY = "https://registry.npmjs.org/"
LICENCES = {
    "MIT", "ISC", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "MPL-2.0", "Python-2.0", "(MIT AND Zlib)",
    "(WTFPL OR MIT)", "(Apache-2.0 AND BSD-3-Clause)",
    "none",
}  # fmt: skip
# Their scripts were looked at: esbuild's checks that its program runs.
MAY_RUN_SCRIPTS = {"esbuild", "fsevents"}


def packages_of(lock):
    """Yields path, name and record of every package of a lock."""
    for path, record in lock["packages"].items():
        if path and not record.get("link"):
            yield path, record.get("name") or path.split("node_modules/")[-1], record


def row_of(name, record):
    use = "build" if record.get("dev") or record.get("devOptional") else "page"
    licence = record.get("license") or "none"
    return (use, name, record["version"], licence.replace(" ", "_"), record.get("integrity", "none"))


def faults_of_record(lock, path, name, record):
    resolved = record.get("resolved", REGISTRY)
    if not resolved.startswith(REGISTRY):
        yield f"{lock}: {path} comes from {resolved}, must come from {REGISTRY}"
    if not record.get("integrity", "").startswith("sha512-"):
        yield f"{lock}: {path} has no SHA-512"
    if record.get("hasInstallScript") and name not in MAY_RUN_SCRIPTS:
        yield f"{lock}: {path} runs a script when it is installed, which nobody has looked at"
    licence = record.get("license") or "none"
    if licence not in LICENCES:
        yield f"{lock}: {path} is under {licence}, which is not among those that were looked at"


def read_list(root):
    lines = (root / LIST).read_text().splitlines() if (root / LIST).exists() else []
    return {tuple(line.split()) for line in lines if line and not line.startswith("#")}


def read_locks(root):
    """Returns the rows that the locks need, and what is wrong with the locks themselves."""
    rows, faults = set(), []
    for lock in LOCKS:
        for path, name, record in packages_of(json.loads((root / lock).read_text())):
            faults += faults_of_record(lock, path, name, record)
            rows.add(row_of(name, record))
    return rows, faults


def faults_of_installed(root, rows):
    known = {row[1:3] + row[4:] for row in rows}
    for place in INSTALLED:
        if not (root / place).exists():
            continue
        for path, name, record in packages_of(json.loads((root / place).read_text())):
            if (name, record["version"], record.get("integrity", "none")) not in known:
                yield f"{place}: {path} {record['version']} is installed and in no lock; run deploy/setup"


def faults(root):
    rows, found = read_locks(root)
    allowed = read_list(root)
    for row in sorted(rows - allowed):
        found.append(f"{LIST} has not: {' '.join(row)}; look at the package, then run check_packages.py . --write")
    for row in sorted(allowed - rows):
        found.append(f"{LIST} has, and no lock does: {' '.join(row)}")
    return found + list(faults_of_installed(root, rows))


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    if sys.argv[2:] == ["--write"]:
        head = "# Use, name, version, licence and SHA-512 of every npm package: see tests/web/check_packages.py\n"
        (root / LIST).write_text(head + "".join(" ".join(row) + "\n" for row in sorted(read_locks(root)[0])))
    found = faults(root)
    print("\n".join(found) or "every npm package is one that was looked at")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
