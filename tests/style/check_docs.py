#!/usr/bin/env python3
"""Checks the documentation: the README stays short, and every relative link leads to something that exists.

    tests/style/check_docs.py ROOT

It looks at README.md, CONTRIBUTING.md and core/doc/**/*.md. It prints file:line for everything that is wrong, and exits
with 1 when there is anything.
"""

import pathlib
import re
import sys
import urllib.parse

README_LINES = 100
LINK = re.compile(r"""\]\(\s*<?([^)\s>]+)|^\s*\[[^\]]+\]:\s+<?([^\s>]+)|<(?:a|img)\b[^>]*\b(?:href|src)=["']([^"']+)""")
FENCE = re.compile(r"^ {0,3}(```|~~~)")
INLINE_CODE = re.compile(r"`[^`]*`")


def links_of(text):
    """Line number and target of every link outside of code."""
    fence = None
    for number, line in enumerate(text.splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence in (None, mark.group(1)):
            fence = None if fence else mark.group(1)
        elif fence is None:
            for found in LINK.finditer(INLINE_CODE.sub("code", line)):
                yield number, next(group for group in found.groups() if group)


def is_relative(target):
    return not re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:|//", target) and not target.startswith("#")


def breaches(root):
    readme = root / "README.md"
    lines = len(readme.read_text().splitlines())
    if lines > README_LINES:
        yield f"README.md:{README_LINES + 1}: the README has {lines} lines and may have {README_LINES}"
    for page in [readme, root / "CONTRIBUTING.md", *sorted((root / "core/doc").rglob("*.md"))]:
        name = page.relative_to(root).as_posix()
        if not page.is_file():
            yield f"{name}:1: the file is missing"
            continue
        for number, target in links_of(page.read_text()):
            path = urllib.parse.unquote(target.split("#")[0].split("?")[0])
            if not is_relative(target):
                continue
            end = (page.parent / path).resolve()
            if not end.is_relative_to(root) or not end.exists():
                yield f"{name}:{number}: the link leads nowhere: {target}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    found = list(breaches(root))
    print("\n".join(found) or "every link leads to something that exists")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
