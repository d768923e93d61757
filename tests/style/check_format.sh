#!/usr/bin/env bash
# Every C++ source is as clang-format 14 lays it out by .clang-format.
#   tests/style/check_format.sh ROOT          check
#   tests/style/check_format.sh ROOT --fix    rewrite
set -euo pipefail
cd "$1"
mapfile -d '' sources < <(find core server client tests \( -name '*.h' -o -name '*.cc' \) -print0 | sort -z)
if [ "${2:-}" = --fix ]; then
  clang-format-14 -i "${sources[@]}"
else
  clang-format-14 --dry-run --Werror "${sources[@]}"
fi
echo "${#sources[@]} files are formatted"
