#!/usr/bin/env python3
"""Changes the real locks in the ways that nobody must miss, and asks check_packages.py.

    tests/web/test_check_packages.py ROOT
"""

import json
import pathlib
import shutil
import sys
import tempfile

import check_packages

ROOT = pathlib.Path(sys.argv[1]).resolve()


def other_version(lock):
    lock["packages"]["node_modules/preact"]["version"] = "10.27.3"


def other_bytes(lock):
    lock["packages"]["node_modules/preact"]["integrity"] = "sha512-" + "A" * 86 + "=="


def another_package(lock):
    record = {"version": "1.0.0", "license": "MIT", "integrity": "sha512-" + "B" * 86 + "=="}
    lock["packages"]["node_modules/preact-helper"] = record


def other_source(lock):
    lock["packages"]["node_modules/preact"]["resolved"] = "https://example.org/preact.tgz"


def a_script(lock):
    lock["packages"]["node_modules/preact"]["hasInstallScript"] = True


def other_licence(lock):
    lock["packages"]["node_modules/preact"]["license"] = "UNLICENSED"


def from_build_to_page(lock):
    del lock["packages"]["node_modules/vite"]["dev"]


def one_less(lock):
    del lock["packages"]["node_modules/preact"]


CHANGES = [
    other_version,
    other_bytes,
    another_package,
    other_source,
    a_script,
    other_licence,
    from_build_to_page,
    one_less,
]


def faults_after(change):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in (*check_packages.LOCKS, check_packages.LIST):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, root / name)
        path = root / check_packages.LOCKS[0]
        lock = json.loads(path.read_text())
        change(lock)
        path.write_text(json.dumps(lock))
        return check_packages.faults(root)


def main():
    missed = [change.__name__ for change in CHANGES if not faults_after(change)]
    missed += [f"nothing was changed, and yet: {fault}" for fault in faults_after(lambda lock: None)]
    print("\n".join(missed) or f"all {len(CHANGES)} changes are found")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
