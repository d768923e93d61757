"""Which field of a plan file a parser complains of, and what may stand there."""

from __future__ import annotations

import difflib
import re
from typing import Tuple

from lipofill.errors import FieldViolation
from lipofill.v1 import plan_pb2

_UNKNOWN_FIELD = re.compile(
    r'no field named "(?P<name>[^"]+)" at "Plan\.?(?P<path>[^"]*)".*?\[(?P<known>.*)\]', re.DOTALL
)
_UNKNOWN_NAME = re.compile(
    r"Invalid enum value (?P<name>.+) for enum type (?P<type>[\w.]+) at Plan\.(?P<path>[^\s\"]*)"
)


def violations_of(message: str) -> Tuple[FieldViolation, ...]:
    """The field that a parser's message complains of, with the nearest name there is, or all that
    its value may be.
    """
    value = _UNKNOWN_NAME.search(message)
    if value is not None:
        known = plan_pb2.DESCRIPTOR.pool.FindEnumTypeByName(value["type"]).values_by_name
        names = ", ".join(name for name in known if not name.endswith("_UNSPECIFIED"))
        return (FieldViolation(value["path"].rstrip("."), f'is "{value["name"]}", must be one of {names}'),)
    found = _UNKNOWN_FIELD.search(message)
    if found is None:
        return ()
    near = difflib.get_close_matches(found["name"], re.findall(r"'(\w+)'", found["known"]), 1)
    path = ".".join(part for part in (found["path"], found["name"]) if part)
    return (FieldViolation(path, "is no field" + (f"; do you mean {near[0]}?" if near else "")),)
