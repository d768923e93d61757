#!/usr/bin/env python3
"""Checks how programs are built: at a place in memory that nobody knows beforehand (PIE), with
tables of addresses that nobody can write once they run (full RELRO), a stack that holds no code
and guards its returns, and calls that know the size of what they write to (FORTIFY).

    check_hardening.py [--skip-compiled] PROGRAM...

With --skip-compiled it checks what the linker does alone, for builds with sanitizers or without
optimisation. It prints what is missing, and ends with 1 then. Needs readelf; exit code 77, a skip,
without it.
"""

import re
import shutil
import subprocess
import sys


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *arguments], capture_output=True, text=True, check=True).stdout


def faults_of(program, compiled):
    """What a program lacks, in words."""
    header, segments, dynamic = readelf("-h", program), readelf("-l", program), readelf("-d", program)
    if not re.search(r"Type:\s+DYN", header):
        yield "it is not position independent (-fPIE, -pie)"
    if "GNU_RELRO" not in segments:
        yield "it has no RELRO segment (-z relro)"
    if not re.search(r"\bBIND_NOW\b|FLAGS_1.*\bNOW\b", dynamic):
        yield "symbols are bound late, so its RELRO is partial (-z now)"
    stack = re.search(r"GNU_STACK.*", segments)
    if stack is None or re.search(r"\bRWE\b", stack.group()):
        yield "its stack may hold code (-z noexecstack)"
    if re.search(r"LOAD.*\bRWE\b", segments):
        yield "it has memory that may be written and run"
    if re.search(r"\((RPATH|RUNPATH)\)(?!.*\[/)", dynamic):
        yield "it looks for libraries at a place relative to where it is started"
    if not compiled:
        return
    symbols = readelf("--dyn-syms", program)
    if "__stack_chk_fail" not in symbols:
        yield "it does not guard its stack (-fstack-protector-strong)"
    if not re.search(r"__\w+_chk\b", symbols.replace("__stack_chk_fail", "")):
        yield "its calls do not check sizes (_FORTIFY_SOURCE)"


def main():
    if shutil.which("readelf") is None:
        print("readelf is not installed")
        return 77
    compiled = "--skip-compiled" not in sys.argv
    programs = [argument for argument in sys.argv[1:] if argument not in ("", "--skip-compiled")]
    found = [f"{program}: {fault}" for program in programs for fault in faults_of(program, compiled)]
    print("\n".join(found) or f"{len(programs)} programs are built as they should be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
