#!/usr/bin/env python3
"""Runs clang-tidy with the checks of .clang-tidy, and remembers what was clean.

    tests/style/tidy.py ROOT BUILD [FOLDER...]    all folders of core, server and client, or these

What takes the time is not the sources but what they include, so the files of a folder are one
translation unit; where two of them use one name for different things, they are divided until they
fit. A unit whose sources, headers and checks are as they were when it was clean is not run again:
BUILD/tidy has a stamp for each, named by a hash of their content. BUILD needs compile_commands.json
and the sources that are made from the schema. It exits with 1 when there is anything to mend.
"""

import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

PROGRAM = "clang-tidy-14"
PARTS = ("core", "server", "client")
INCLUDE = re.compile(r'^\s*#\s*include\s+["<]([^">]+)[">]', re.M)
#: Warnings are for the compiler that builds, whose options clang does not know in part.
FLAG = re.compile(r"-(I|D|std=|isystem|fopenmp|m)")


class Tidy:
    def __init__(self, root, build):
        self.root, self.build = root, build
        self.stamps = build / "tidy"
        self.stamps.mkdir(parents=True, exist_ok=True)
        commands = json.loads((build / "compile_commands.json").read_text())
        self.flags = {pathlib.Path(command["file"]): self._flags_of(command) for command in commands}
        self.version = subprocess.run([PROGRAM, "--version"], capture_output=True, check=True).stdout
        self.checks = (root / ".clang-tidy").read_bytes()

    def _flags_of(self, command):
        """Returns the flags that decide how a file is read, with absolute folders."""
        words, flags = iter(shlex.split(command["command"])[1:]), []
        for word in words:
            if word == "-isystem":
                flags += [word, os.path.join(command["directory"], next(words))]
            elif word.startswith("-I"):
                flags.append("-I" + os.path.normpath(os.path.join(command["directory"], word[2:])))
            elif FLAG.match(word):
                flags.append(word)
        return tuple(flags)

    def folders(self):
        """Returns the sources to check by their folder."""
        found = collections.defaultdict(list)
        for source in sorted(self.flags):
            if source.is_relative_to(self.root) and not source.is_relative_to(self.build):
                folder = source.parent.relative_to(self.root)
                if folder.parts[0] in PARTS:
                    found[folder.as_posix()].append(source)
        return found

    @functools.lru_cache(maxsize=None)
    def _included(self, file):
        names = INCLUDE.findall(file.read_text(errors="replace"))
        candidates = [base / name for name in names for base in (self.root, self.build, self.build / "proto")]
        return [path for path in candidates if path.is_file()]

    def _key(self, sources):
        """Hashes what the outcome depends on: sources, what they include of the project, checks."""
        waiting, seen = list(sources), set()
        while waiting:
            file = waiting.pop()
            if file not in seen:
                seen.add(file)
                waiting += self._included(file)
        digest = hashlib.sha256(self.version + self.checks + repr(self.flags[sources[0]]).encode())
        for file in sorted(seen):
            digest.update(file.as_posix().encode() + b"\0" + file.read_bytes())
        return digest.hexdigest()

    def check(self, sources):
        """Returns what clang-tidy says of the sources, as lines; none where they are clean."""
        key = self._key(sources)
        if (self.stamps / key).exists():
            return []
        unit = self.stamps / f"{key}.cc"
        unit.write_text("".join(f'#include "{source.relative_to(self.root).as_posix()}"\n' for source in sources))
        command = [PROGRAM, "--quiet", f"--config-file={self.root}/.clang-tidy", str(unit), "--"]
        done = subprocess.run(
            [*command, *self.flags[sources[0]], f"-I{self.root}"], capture_output=True, text=True, cwd=self.root
        )
        unit.unlink()
        if "[clang-diagnostic-error" in done.stdout and len(sources) > 1:
            middle = len(sources) // 2
            found = self.check(sources[:middle]) + self.check(sources[middle:])
        else:
            found = done.stdout.splitlines() or done.stderr.splitlines() * (done.returncode != 0)
        if not found:
            (self.stamps / key).touch()
        return found


def main():
    root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    tidy = Tidy(root, build)
    folders = tidy.folders()
    chosen = [folder.rstrip("/") for folder in sys.argv[3:]] or list(folders)
    unknown = [folder for folder in chosen if folder not in folders]
    if unknown:
        sys.exit(f"tidy: no sources of core, server or client are in {', '.join(unknown)}")
    n_found = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = {pool.submit(tidy.check, folders[folder]): folder for folder in chosen}
        for run in concurrent.futures.as_completed(runs):
            found = run.result()
            n_found += len(found)
            print(
                "\n".join([f"tidy: {runs[run]} " + ("is clean" if not found else "is not clean:"), *found]), flush=True
            )
    sys.exit(1 if n_found else 0)


if __name__ == "__main__":
    main()
