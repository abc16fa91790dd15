#!/usr/bin/env bash
# Installs a build into an empty prefix and builds the example project against it, once through
# CMake and once through pkg-config, then runs the controller on a live stream.
#   run.sh SOURCE BUILD WORK
set -euo pipefail
source=$1
build=$2
work=$3
stream=example.$$

rm -rf "$work"
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source/examples" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/cmake" >/dev/null

pkg=$(find "$work/prefix" -name splinecast.pc -printf '%h')
flags=$(PKG_CONFIG_PATH=$pkg pkg-config --cflags --libs splinecast)
# shellcheck disable=SC2086
g++ -std=c++20 "$source/examples/controller.cpp" $flags -o "$work/pkg_config"

printf 't,x\n0,1.5\n0.1,1.5\n0.2,1.5\n' >"$work/line.csv"
program=$work/prefix/bin/splinecast
for controller in "$work/cmake/controller" "$work/pkg_config"; do
  "$controller" "$stream" >"$work/out" &
  reading=$!
  "$program" replay "$work/line.csv" --stream "$stream" --embedded 2>/dev/null
  wait "$reading"
  "$program" rm "$stream"
  grep -qx 1.5 "$work/out" || { echo "$controller read nothing"; exit 1; }
  echo "$controller read $(wc -l <"$work/out") samples"
done
