#!/usr/bin/env bash
# Installs a build into an empty prefix, compiles each installed header alone, and builds the example
# project against the package: through CMake with the shared library and the static one, and through
# pkg-config. Then runs each controller on a live stream.
#   run.sh SOURCE BUILD WORK
set -euo pipefail
source=$1
build=$2
work=$3
stream=example.$$

rm -rf "$work"
cmake --install "$build" --prefix "$work/prefix" >/dev/null

headers=$(cd "$work/prefix/include" && find . -name '*.hpp' -printf '%P\n' | sort)
count=$(wc -l <<<"$headers")
[ "$count" -le 22 ] || { echo "$count headers are installed, more than 22"; exit 1; }
for header in $headers; do
  printf '#include <%s>\nint main() {}\n' "$header" >"$work/header.cpp"
  g++ -std=c++20 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only \
    -isystem /usr/include/eigen3 -I"$work/prefix/include" "$work/header.cpp"
done
echo "$count installed headers, each compiled alone"

cmake -S "$source/examples" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/cmake" >/dev/null

pkg=$(find "$work/prefix" -name splinecast.pc -printf '%h')
flags=$(PKG_CONFIG_PATH=$pkg pkg-config --cflags --libs splinecast)
libraries=$(dirname "$(find "$work/prefix" -name 'libsplinecast.so')")
# shellcheck disable=SC2086
g++ -std=c++20 "$source/examples/controller.cpp" $flags "-Wl,-rpath,$libraries" -o "$work/pkg_config"

for shared in "$work/cmake/controller" "$work/pkg_config"; do
  objdump -p "$shared" | grep -q 'NEEDED *libsplinecast\.so\.0\.1$' ||
    { echo "$shared is not linked to libsplinecast.so.0.1"; exit 1; }
done

printf 't,x\n0,1.5\n0.1,1.5\n0.2,1.5\n' >"$work/line.csv"
program=$work/prefix/bin/splinecast
for controller in "$work/cmake/controller" "$work/cmake/controller_static" "$work/pkg_config"; do
  "$controller" "$stream" >"$work/out" &
  reading=$!
  "$program" replay "$work/line.csv" --stream "$stream" --embedded 2>/dev/null
  wait "$reading"
  "$program" rm "$stream"
  grep -qx 1.5 "$work/out" || { echo "$controller read nothing"; exit 1; }
  echo "$controller read $(wc -l <"$work/out") samples"
done
