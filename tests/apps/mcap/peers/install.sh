#!/bin/sh
# Installs the peers with npm into a folder, unless they are there: install.sh FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
exec 9>"$1/lock"
flock 9
cp "$here/package.json" "$here"/*.mjs "$1"
cmp -s "$here/package-lock.json" "$1/node_modules/installed.json" && exit 0
cp "$here/package-lock.json" "$1"
cd "$1"
npm ci --ignore-scripts --no-audit --no-fund >&2
cp package-lock.json node_modules/installed.json
