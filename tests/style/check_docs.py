#!/usr/bin/env python3
"""Checks the documentation: the README stays short, every relative link leads to something that
exists, and pages wrap at 120 columns.

    tests/style/check_docs.py ROOT

It looks at README.md, CONTRIBUTING.md, CHANGELOG.md and core/doc/**/*.md. Tables, code and pages
that a program writes do not wrap. It prints file:line for everything that is wrong.
"""

import re
import urllib.parse

from style import check

README_LINES = 100
MOST_COLUMNS = 120
#: The pages that deploy/api, deploy/bench and deploy/verify write, a paragraph a line.
WRITTEN = {"core/doc/api.md", "core/doc/performance.md", "core/doc/verification.md"}
LINK = re.compile(r"""\]\(\s*<?([^)\s>]+)|^\s*\[[^\]]+\]:\s+<?([^\s>]+)|<(?:a|img)\b[^>]*\b(?:href|src)=["']([^"']+)""")
FENCE = re.compile(r"^ {0,3}(```|~~~)")
INLINE_CODE = re.compile(r"`[^`]*`")


def prose_of(text):
    """Yields number and text of every line outside of fenced code."""
    fence = None
    for number, line in enumerate(text.splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence in (None, mark.group(1)):
            fence = None if fence else mark.group(1)
        elif fence is None:
            yield number, line


def links_of(text):
    """Yields line number and target of every link outside of code."""
    for number, line in prose_of(text):
        for found in LINK.finditer(INLINE_CODE.sub("code", line)):
            yield number, next(group for group in found.groups() if group)


def is_relative(target):
    return not re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:|//", target) and not target.startswith("#")


def lost_links(root, page):
    for number, target in links_of(page.read_text()):
        end = (page.parent / urllib.parse.unquote(target.split("#")[0].split("?")[0])).resolve()
        if is_relative(target) and not (end.is_relative_to(root) and end.exists()):
            yield number, f"the link leads nowhere: {target}"


def wide_lines(page):
    for number, line in prose_of(page.read_text()):
        can_wrap = not line.startswith(("|", "    ")) and " " in line.strip()
        if can_wrap and len(line) > MOST_COLUMNS:
            yield number, f"the line has {len(line)} columns and may have {MOST_COLUMNS}"


def breaches(root):
    pages = [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
    lines = len(pages[0].read_text().splitlines())
    if lines > README_LINES:
        yield f"README.md:{README_LINES + 1}: the README has {lines} lines and may have {README_LINES}"
    for page in [*pages, *sorted((root / "core/doc").rglob("*.md"))]:
        name = page.relative_to(root).as_posix()
        wide = [] if name in WRITTEN else wide_lines(page)
        for number, problem in sorted([*lost_links(root, page), *wide]):
            yield f"{name}:{number}: {problem}"


if __name__ == "__main__":
    check(breaches, "every link leads to something that exists, and every page wraps")
