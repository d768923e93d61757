#!/usr/bin/env python3
"""Checks the container's recipe without building it: every library that the programs load must come
with the packages of the last stage or what they depend on, every file it copies must be there,
every setting it makes must exist.

    check_container.py DOCKERFILE ROOT LIPOFILLD LIPOFILL

Needs dpkg; exit code 77, a skip, without it.
"""

import pathlib
import re
import shutil
import subprocess
import sys


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


def packages_of(recipe):
    """The packages that the last stage installs."""
    last = recipe.replace("\\\n", " ").split("\nFROM ")[-1]
    return re.search(r"apt-get install -y --no-install-recommends (.*?) &&", last).group(1).split()


def closure(packages):
    """The packages and all that they depend on, of those installed here."""
    depends = {}
    for line in run("dpkg-query", "-W", "-f", "${Package}\t${Provides}\t${Pre-Depends}, ${Depends}\n").splitlines():
        name, provides, needs = line.split("\t")
        names = set(re.findall(r"(?:^|[,|])\s*([a-z0-9][a-z0-9+.-]*)", needs))
        depends[name] = names
        for alias in re.findall(r"(?:^|,)\s*([a-z0-9][a-z0-9+.-]*)", provides):
            depends.setdefault(alias, set()).add(name)
    found, waiting = set(), list(packages)
    while waiting:
        name = waiting.pop()
        if name not in found and name in depends:
            found.add(name)
            waiting.extend(depends[name])
    return found, [name for name in packages if name not in depends]


def owners_of(libraries):
    """The package of each file, found in one search: a search reads the lists of all packages."""
    paths = {name for library in libraries for name in (library, str(pathlib.Path(library).resolve()))}
    found = {}
    for line in run("dpkg", "-S", *sorted(paths)).splitlines():
        owner, _, path = line.partition(": ")
        found[path] = owner.split(":")[0].split(",")[0]
    return {library: found.get(library) or found.get(str(pathlib.Path(library).resolve())) for library in libraries}


def missing_libraries(programs, packages):
    for program in programs:
        for library, owner in owners_of(re.findall(r"=> (/\S+)", run("ldd", program))).items():
            if owner not in packages:
                yield f"{pathlib.Path(program).name} loads {library} of {owner}, which the image does not have"


def missing_files(recipe, root):
    for line in re.findall(r"^COPY (?!--from)(.*)$", recipe, re.M):
        for path in line.split()[:-1]:
            if not (root / path).exists():
                yield f"COPY {path}: there is no such file"


def unknown_settings(recipe, lipofilld):
    known = run(lipofilld, "--help")
    for name in re.findall(r"LIPOFILLD_([A-Z_]+)=", recipe):
        if f"--{name.lower().replace('_', '-')} " not in known:
            yield f"LIPOFILLD_{name} is no setting of lipofilld"


def main():
    if shutil.which("dpkg") is None:
        return 77
    recipe = pathlib.Path(sys.argv[1]).read_text()
    root = pathlib.Path(sys.argv[2])
    programs = sys.argv[3:]
    packages, not_here = closure(packages_of(recipe))
    faults = [f"{name} is no package that is installed here" for name in not_here]
    faults += missing_libraries(programs, packages)
    faults += missing_files(recipe, root)
    faults += unknown_settings(recipe, programs[0])
    print("\n".join(faults) or f"the image has all that {len(programs)} programs load, from {len(packages)} packages")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
