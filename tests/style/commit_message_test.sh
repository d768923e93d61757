#!/usr/bin/env bash
# deploy/hooks/commit-msg takes messages that have a short subject and a body, and refuses others.
set -euo pipefail
hook=$1/deploy/hooks/commit-msg
message=$(mktemp)
trap 'rm -f "$message"' EXIT

# expect STATUS MESSAGE: the hook answers the message with this exit code.
expect() {
  printf "%b" "$2" > "$message"
  local status=0
  "$hook" "$message" 2> /dev/null || status=$?
  [ "$status" -eq "$1" ] || { echo "exit code $status instead of $1 for: $2" >&2; exit 1; }
}
exactly_72=$(printf 'x%.0s' {1..72})
expect 0 "Films close\n\nThey stayed open.\n"
expect 0 "$exactly_72\n\nThe longest subject there may be.\n# a comment of git\n"
expect 0 "Merge branch 'films'\n"
expect 1 "${exactly_72}x\n\nA subject that is too long.\n"
expect 1 "Films close\n"
expect 1 "Films close\n# only a comment of git follows\n"
expect 1 "Films close\nThe line below the subject is not empty.\n"
echo "messages are judged by subject and body"
