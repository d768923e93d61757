#!/usr/bin/env python3
"""Checks that classes stay small: in core and server at most 25 private methods and 15 members.

    tests/style/check_classes.py ROOT

A class that grows past that is several classes (CONTRIBUTING.md). Those that are larger today are
listed with what they have, which may only shrink. It prints file:line for every larger class.
"""

import re

from style import check

MOST_METHODS = 25
MOST_MEMBERS = 15
#: Classes that are still too large: private methods and members. One that has been divided leaves.
LARGER = {
    "Metrics": (0, 25),
    "Session": (55, 34),
    "Viewer": (6, 17),
    "WatchStream": (5, 22),
}


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
    seen = set()
    for source in sorted(root.glob("core/**/*.h")) + sorted(root.glob("server/**/*.h")):
        path = source.relative_to(root).as_posix()
        for name, methods, members, line in classes(source.read_text()):
            most_methods, most_members = LARGER.get(name, (MOST_METHODS, MOST_MEMBERS))
            if methods > most_methods or members > most_members:
                yield (
                    f"{path}:{line}: {name} has {methods} private methods and {members} members; "
                    f"it may have {most_methods} and {most_members}"
                )
            if name in LARGER:
                seen.add(name)
                if methods <= MOST_METHODS and members <= MOST_MEMBERS:
                    yield f"{path}:{line}: {name} is small enough now: take it out of LARGER in check_classes.py"
    for name in sorted(LARGER.keys() - seen):
        yield f"tests/style/check_classes.py: there is no class {name}: take it out of LARGER"


if __name__ == "__main__":
    check(breaches, "every class is small enough, or no larger than it was")
