#!/usr/bin/env python3
"""Checks that comments and docstrings wrap at 100 columns, which is as wide as prose reads well.

    tests/style/check_comments.py ROOT

Lines that hold nothing but a comment count; a remark behind code shares the width of the code.
What is set in columns, such as formulas, tables and lists of options, may have 120, and a word that
cannot be divided any length. It prints file:line for every line that is longer.
"""

import ast
import re

from style import check, repository_files

PROSE_COLUMNS = 100
TABLE_COLUMNS = 120
SLASHES = re.compile(r"\s*(///?<?|/\*\*?|\*)( |$)")
HASHES = re.compile(r"\s*#:?( |$)")
MARKS = dict.fromkeys((".h", ".cc", ".ts", ".tsx", ".mjs", ".proto", ".css"), SLASHES)
MARKS.update(dict.fromkeys((".py", ".sh", ".txt", ".cmake", ".toml", ".yaml", ".yml"), HASHES))
#: Copies of other projects' schemas, and inputs of tests.
OTHERS = ("proto/google", "proto/grpc", "tests/fuzz/corpus")


def mark_of(root, path):
    """Returns the pattern that begins a comment in a file, None for files without comments."""
    if path.suffix:
        return MARKS.get(path.suffix)
    return HASHES if path.name == "Dockerfile" or (root / path).read_bytes().startswith(b"#!") else None


def docstring_lines(text):
    """Yields the numbers of the lines that the docstrings of a Python file fill."""
    for node in ast.walk(ast.parse(text)):
        first = node.body[0] if isinstance(getattr(node, "body", None), list) and node.body else None
        if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
            yield from range(first.lineno, first.end_lineno + 1)


def most_columns(prose):
    """Returns how wide a line may be that says `prose` behind its mark, or None where it cannot
    wrap.
    """
    if re.match(r"\s{2,}|[|<]", prose) or re.search(r"\S\s{2,}\S", prose):
        return TABLE_COLUMNS
    return PROSE_COLUMNS if len(prose.split()) > 1 else None


def breaches(root):
    for path in repository_files(root):
        mark = mark_of(root, path)
        if mark is None or path.as_posix().startswith(OTHERS):
            continue
        text = (root / path).read_text()
        docstrings = set(docstring_lines(text)) if path.suffix == ".py" else set()
        for number, line in enumerate(text.splitlines(), 1):
            begins = mark.match(line)
            if not begins and number not in docstrings:
                continue
            most = most_columns(line[begins.end() :] if begins else line.strip())
            if most and len(line) > most:
                yield f"{path}:{number}: a comment of {len(line)} columns; it may have {most}"


if __name__ == "__main__":
    check(breaches, "every comment wraps")
