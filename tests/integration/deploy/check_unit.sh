#!/usr/bin/env bash
# Checks the systemd unit with systemd's own tools: that it is understood, and that it keeps the
# daemon in its sandbox.
#
#   check_unit.sh UNIT LIPOFILLD
#
# Exit code 77, a skip, where systemd-analyze is not installed.
set -euo pipefail
unit=$1
lipofilld=$2
command -v systemd-analyze >/dev/null || { echo "systemd-analyze is not installed"; exit 77; }

# Of 100; 0 is no exposure at all. A daemon on the network with a store of its own gets about 12.
max_exposure=15

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sed "s#/usr/local/bin/lipofilld#$lipofilld#" "$unit" >"$folder/lipofilld.service"
complaints=$(systemd-analyze verify --man=no "$folder/lipofilld.service" 2>&1 | grep 'lipofilld.service' || true)
if [ -n "$complaints" ]; then
  echo "$complaints"
  exit 1
fi
systemd-analyze security --offline=true --threshold="$max_exposure" "$folder/lipofilld.service" >"$folder/report" || {
  cat "$folder/report"
  exit 1
}
tail -1 "$folder/report"
