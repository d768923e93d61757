#!/usr/bin/env python3
"""Checks that classes stay small: in core and server at most 25 private methods and 15 members.

A class that grows past that is several classes (CONTRIBUTING.md). Exit code 1 and a line a breach.
"""

import re

from style import check

MOST_METHODS = 25
MOST_MEMBERS = 15


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)


def body_after(text, opening):
    """What stands between the brace at `opening` and the one that closes it."""
    depth = 0
    for at in range(opening, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return text[opening + 1 : at]
    return text[opening + 1 :]


def statements(body):
    """Declarations of a class body, each without what stands in its braces; access labels as they
    are.
    """
    statement, depth = "", 0
    for character in body:
        if character == "{":
            depth += 1
        elif character == "}":
            depth -= 1
            if depth == 0:
                statement += "{}"
        elif depth == 0:
            statement += character
        ends = depth == 0 and (
            character == ";" or (character == "}" and re.search(r"\)[\w\s]*(:.*)?\{\}$", statement, re.S))
        )
        label = re.fullmatch(r"\s*(public|private|protected):", statement)
        if ends or label:
            yield " ".join(statement.split())
            statement = ""


def is_method(statement):
    if re.match(r"(class|struct|enum|using|friend|template|typedef|static_assert)\b", statement):
        return statement.startswith("template") and "(" in statement
    head = re.sub(r"<[^<>]*>", "", re.sub(r"<[^<>]*>", "", statement))
    return re.search(r"[\w~=]+\s*\(", head) is not None and not re.search(r"\b\w+_\s*(=|;|\{)", head.split("(")[0])


def is_member(statement):
    if re.match(r"(class|struct|enum|using|friend|template|typedef|static|inline static)\b", statement):
        return False
    return not is_method(statement) and re.search(r"\b\w+_\s*(\[[^\]]*\])?\s*(=[^=]|\{\}|;|,)", statement) is not None


def classes(text):
    text = without_comments(text)
    for match in re.finditer(r"^class (\w+)[^;{]*\{", text, flags=re.M):
        methods = members = 0
        access = "private"
        for statement in statements(body_after(text, match.end() - 1)):
            if re.fullmatch(r"(public|private|protected):", statement):
                access = statement[:-1]
            elif is_member(statement):
                members += statement.count("_,") + 1
            elif access == "private" and is_method(statement):
                methods += 1
        yield match.group(1), methods, members, text[: match.start()].count("\n") + 1


def breaches(root):
    for source in sorted(root.glob("core/**/*.h")) + sorted(root.glob("server/**/*.h")):
        path = source.relative_to(root).as_posix()
        for name, methods, members, line in classes(source.read_text()):
            if methods > MOST_METHODS or members > MOST_MEMBERS:
                yield (
                    f"{path}:{line}: {name} has {methods} private methods and {members} members; "
                    f"it may have {MOST_METHODS} and {MOST_MEMBERS}"
                )


if __name__ == "__main__":
    check(breaches, "every class is small enough")
