"""What the style checks share: the files they look at, and how they say what they found."""

import pathlib
import subprocess
import sys


def repository_files(root):
    """Returns the files of the source tree, relative to it, without what the build makes."""
    listed = subprocess.run(
        ["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"], capture_output=True
    )
    if listed.returncode == 0:
        paths = [pathlib.Path(name) for name in listed.stdout.decode().split("\0") if name]
    else:  # an unpacked archive
        made = {"build", "demo-output"}
        paths = [path.relative_to(root) for path in root.rglob("*") if path.relative_to(root).parts[0] not in made]
    return sorted(path for path in paths if (root / path).is_file() and not (root / path).is_symlink())


def check(breaches, what_holds):
    """Runs `breaches` on the root that the command line names, and prints what it yields. The exit
    code is 1 where it yields anything.
    """
    root = pathlib.Path(sys.argv[1]).resolve()
    found = list(breaches(root))
    print("\n".join(found) or what_holds)
    sys.exit(1 if found else 0)
