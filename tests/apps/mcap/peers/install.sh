#!/bin/sh
# Installs the peers with npm into a folder, unless they are there: install.sh FOLDER
# A failure is remembered for ten minutes, so that a run of the tests waits for a missing registry once.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
exec 9>"$1/lock"
flock 9
# Other tests may read these files now: each is replaced as a whole, and only by another one.
for file in "$here/package.json" "$here"/*.mjs; do
  at="$1/$(basename "$file")"
  cmp -s "$file" "$at" || { cp "$file" "$at.new" && mv "$at.new" "$at"; }
done
cmp -s "$here/package-lock.json" "$1/node_modules/installed.json" && exit 0
cp "$here/package-lock.json" "$1"
cd "$1"
# Where the tests fail without a registry, npm tries more often.
retries=1
[ "${CI:-}" != true ] || retries=2
if [ -z "$(find . -maxdepth 1 -name failed -mmin -10)" ]; then
  if npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=$retries >failed 2>&1; then
    cp package-lock.json node_modules/installed.json
    rm failed
    exit 0
  fi
fi
cat failed >&2
exit 1
