#!/usr/bin/env bash
# Runs the program in C and checks what it prints.
#   program.sh PROGRAM SPLINECAST
set -euo pipefail
stream=test.$$.c_program
trap '"$2" rm "$stream" >/dev/null 2>&1 || true' EXIT
output=$("$1" "$stream")
echo "$output"
for line in 'replacement accepted' 'at rest at 0\.000, 0\.150 m; .*' '0 refused' 'the fit passes 0\.106, 0\.106 m'; do
  grep -Eqx "$line" <<<"$output" || { echo "it has not printed a line '$line'"; exit 1; }
done
