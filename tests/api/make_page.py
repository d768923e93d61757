#!/usr/bin/env python3
"""Writes the reference of the API from the comments of the schema.

    make_page.py IMAGE.json PAGE.md

IMAGE.json is what `buf build -o -#format=json` prints: the descriptors with their comments.
"""

import json
import re
import sys

HEAD = """# API reference

The wire schema of the daemon, package `lipofill.v1`, from its own comments: `proto/lipofill/v1` has the same in the language of
Protocol Buffers. `deploy/api` writes this page. A plan file is the JSON form of [Plan](#plan). Errors are google.rpc.Status with an
ErrorInfo and, for arguments, a BadRequest that names each field, its value and its bound. Fields marked *optional* tell absent from
zero; their defaults are in their comments.

"""
SCALARS = {
    "TYPE_DOUBLE": "double",
    "TYPE_FLOAT": "float",
    "TYPE_INT64": "int64",
    "TYPE_UINT64": "uint64",
    "TYPE_INT32": "int32",
    "TYPE_BOOL": "bool",
    "TYPE_STRING": "string",
    "TYPE_BYTES": "bytes",
    "TYPE_UINT32": "uint32",
}
# Numbers of the fields of FileDescriptorProto, DescriptorProto, EnumDescriptorProto and
# ServiceDescriptorProto.
MESSAGES, ENUMS, SERVICES, NESTED, NESTED_ENUMS, FIELDS, VALUES, METHODS = 4, 5, 6, 3, 4, 2, 2, 2


def comments_of(file):
    found = {}
    for location in file["sourceCodeInfo"]["location"]:
        texts = [location.get(kind, "") for kind in ("leadingComments", "trailingComments")]
        text = " ".join(" ".join(texts).split())
        if text:
            found[tuple(location.get("path", []))] = text
    return found


def short(type_name):
    return type_name.removeprefix(".lipofill.v1.")


def anchor(name):
    return re.sub(r"[^a-z0-9_-]", "", name.lower())


def link(type_name, known):
    name = short(type_name)
    return f"[{name}](#{anchor(name)})" if name in known else f"`{name.lstrip('.')}`"


def type_of(field, maps, known):
    kind = SCALARS.get(field["type"]) or link(field["typeName"], known)
    if field.get("typeName") in maps:
        key, value = maps[field["typeName"]]["field"]
        return f"map of {type_of(key, maps, known)} to {type_of(value, maps, known)}"
    if field.get("label") == "LABEL_REPEATED":
        return f"repeated {kind}"
    return f"optional {kind}" if field.get("proto3Optional") else kind


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows] + [""]


def enum_lines(enum, name, path, comments):
    rows = [(f"`{value['name']}`", comments.get(path + (VALUES, k), "")) for k, value in enumerate(enum["value"])]
    return [f"### {name}", "", comments.get(path, ""), ""] + table(("value", "meaning"), rows)


def message_lines(message, name, path, comments, known):
    maps = {
        f".lipofill.v1.{name}.{m['name']}": m
        for m in message.get("nestedType", [])
        if m.get("options", {}).get("mapEntry")
    }
    oneofs = [o["name"] for o in message.get("oneofDecl", [])]
    rows = []
    for k, field in enumerate(message.get("field", [])):
        text = comments.get(path + (FIELDS, k), "")
        if "oneofIndex" in field and not field.get("proto3Optional"):
            text = f"One of `{oneofs[field['oneofIndex']]}`. {text}"
        rows.append((f"`{field['name']}`", type_of(field, maps, known), text))
    lines = [f"### {name}", "", comments.get(path, ""), ""]
    lines += table(("field", "type", "meaning"), rows) if rows else []
    for k, enum in enumerate(message.get("enumType", [])):
        lines += enum_lines(enum, f"{name}.{enum['name']}", path + (NESTED_ENUMS, k), comments)
    for k, nested in enumerate(message.get("nestedType", [])):
        if not nested.get("options", {}).get("mapEntry"):
            lines += message_lines(nested, f"{name}.{nested['name']}", path + (NESTED, k), comments, known)
    return lines


def service_lines(service, path, comments, known):
    rows = []
    for k, method in enumerate(service["method"]):
        request = ("stream of " if method.get("clientStreaming") else "") + link(method["inputType"], known)
        response = ("stream of " if method.get("serverStreaming") else "") + link(method["outputType"], known)
        rows.append((f"`{method['name']}`", request, response, comments.get(path + (METHODS, k), "")))
    return [f"## {service['name']}", "", comments.get(path, ""), ""] + table(("method", "takes", "gives", ""), rows)


def names_in(message, prefix=""):
    name = prefix + message["name"]
    yield name
    for enum in message.get("enumType", []):
        yield f"{name}.{enum['name']}"
    for nested in message.get("nestedType", []):
        if not nested.get("options", {}).get("mapEntry"):
            yield from names_in(nested, name + ".")


def main():
    image, page = sys.argv[1:]
    files = [file for file in json.load(open(image))["file"] if file["name"].startswith("lipofill/v1/")]
    known = {name for file in files for message in file.get("messageType", []) for name in names_in(message)}
    known |= {enum["name"] for file in files for enum in file.get("enumType", [])}
    services, types = [], []
    for file in files:
        comments = comments_of(file)
        for k, service in enumerate(file.get("service", [])):
            services += service_lines(service, (SERVICES, k), comments, known)
        types += [f"## {file['name']}", "", comments.get((12,), comments.get((2,), "")), ""]
        for k, message in enumerate(file.get("messageType", [])):
            types += message_lines(message, message["name"], (MESSAGES, k), comments, known)
        for k, enum in enumerate(file.get("enumType", [])):
            types += enum_lines(enum, enum["name"], (ENUMS, k), comments)
    with open(page, "w") as out:
        out.write(HEAD + re.sub(r"\n{3,}", "\n\n", "\n".join(services + types)).rstrip() + "\n")


main()
