#!/usr/bin/env python3
"""Puts the Python package together in a build tree: the hand-written modules, and what protoc makes
of the wire schema.

The folder can be used in place (PYTHONPATH) and installed (`pip install FOLDER`). Hand-written
files are linked, so that an edit shows at once. google.rpc goes to lipofill.google_rpc.own: other
packages bring a google.rpc of their own.

    assemble.py --proto proto --out build/release/python [--protoc protoc]
        [--grpc-plugin grpc_python_plugin]
"""

import argparse
import pathlib
import re
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
OWN_RPC = "lipofill/google_rpc/own"
WELL_KNOWN = {"google.protobuf.Empty": "google.protobuf.empty_pb2.Empty"}


def link_sources(out):
    """Links every hand-written file below lipofill/, and what pip needs, and takes away links that
    lead nowhere.
    """
    for link in out.rglob("*"):
        if link.is_symlink() and not link.exists():
            link.unlink()
    for source in [HERE / "pyproject.toml", *(HERE / "lipofill").rglob("*")]:
        if source.is_dir() or source.suffix == ".pyc":
            continue
        link = out / source.relative_to(HERE)
        link.parent.mkdir(parents=True, exist_ok=True)
        if not link.is_symlink() or link.resolve() != source:
            link.unlink(missing_ok=True)
            link.symlink_to(source)


def run_protoc(arguments, proto, out):
    """Messages with type stubs for all of the schema, callable stubs for its services."""
    files = [path for folder in ("lipofill", "google/rpc") for path in (proto / folder).rglob("*.proto")]
    names = sorted(str(path.relative_to(proto)) for path in files)
    services = [name for name in names if name.endswith("_service.proto")]
    include = [arguments.protoc, f"-I{proto}"]
    subprocess.run([*include, f"--python_out={out}", f"--pyi_out={out}", *names], check=True)
    plugin = f"--plugin=protoc-gen-grpc_python={shutil.which(arguments.grpc_plugin)}"
    subprocess.run([*include, plugin, f"--grpc_python_out={out}", *services], check=True)
    return services


def move_google_rpc(out):
    """google/rpc goes below lipofill; what imports it follows."""
    target = out / OWN_RPC
    target.mkdir(parents=True, exist_ok=True)
    (target / "__init__.py").write_text('"""google.rpc as generated from the project\'s own copy."""\n')
    for generated in (out / "google/rpc").iterdir():
        generated.replace(target / generated.name)
    shutil.rmtree(out / "google")
    for generated in [*(out / "lipofill/v1").glob("*_pb2*.py*"), *target.glob("*_pb2*.py*")]:
        text = generated.read_text()
        text = re.sub(r"from google\.rpc import (\w+)_pb2", r"from lipofill.google_rpc import \1_pb2", text)
        generated.write_text(text)


def python_type(proto_type, imports):
    """The Python class of a message named in an rpc line; notes the module it is in."""
    if proto_type in WELL_KNOWN:
        full = WELL_KNOWN[proto_type]
        imports.add(full.rsplit(".", 1)[0])
        return full
    module = f"lipofill.v1.{MODULE_OF[proto_type]}_pb2"
    imports.add(module)
    return f"{module}.{proto_type}"


MODULE_OF = {}


def index_messages(proto):
    """Which file of the schema each message is in."""
    for path in (proto / "lipofill/v1").glob("*.proto"):
        for name in re.findall(r"^message (\w+)", path.read_text(), re.MULTILINE):
            MODULE_OF[name] = path.stem


def write_service_stubs(proto, out, service_file):
    """The type stub of a _pb2_grpc module: protoc has none for services."""
    text = re.sub(r"//.*", "", (proto / service_file).read_text())
    imports, classes = set(), []
    for name, body in re.findall(r"^service (\w+) \{(.*?)^\}", text, re.MULTILINE | re.DOTALL):
        lines = [f"class {name}Stub:", "    def __init__(self, channel: Any) -> None: ..."]
        for method, asks, takes, answers, gives in re.findall(
            r"rpc (\w+)\((stream )?([\w.]+)\)\s*returns\s*\((stream )?([\w.]+)\)", body
        ):
            kind = ("Stream" if asks else "Unary") + ("Stream" if answers else "Unary")
            lines.append(f"    {method}: {kind}[{python_type(takes, imports)}, {python_type(gives, imports)}]")
        classes.append("\n".join(lines))
    head = ["from typing import Any", "", *(f"import {module}" for module in sorted(imports))]
    head.append("from lipofill.rpc_types import StreamUnary, UnaryStream, UnaryUnary")
    stub = out / service_file.replace(".proto", "_pb2_grpc.pyi")
    stub.write_text("\n".join(head) + "\n\n" + "\n\n".join(classes) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--proto", type=pathlib.Path, required=True, help="folder of the wire schema")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--protoc", default="protoc")
    parser.add_argument("--grpc-plugin", default="grpc_python_plugin")
    arguments = parser.parse_args()
    proto, out = arguments.proto.resolve(), arguments.out.resolve()
    shutil.rmtree(out / "lipofill/v1", ignore_errors=True)
    out.mkdir(parents=True, exist_ok=True)
    link_sources(out)
    services = run_protoc(arguments, proto, out)
    move_google_rpc(out)
    about = '"""The messages and services of lipofill.v1, generated from the wire schema."""\n'
    (out / "lipofill/v1/__init__.py").write_text(about)
    index_messages(proto)
    for service_file in services:
        write_service_stubs(proto, out, service_file)


if __name__ == "__main__":
    main()
