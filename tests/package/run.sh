#!/usr/bin/env bash
# Installs a build into an empty prefix, compiles each installed header alone, and builds the examples
# against the package: through CMake with the shared library and the static one, and through
# pkg-config. Then runs all of them on live streams and checks what they print.
#   run.sh SOURCE BUILD WORK
set -euo pipefail
source=$1
build=$2
work=$3
stream=test.$$.example
warnings="-Wall -Wextra -Werror"

rm -rf "$work"
cmake --install "$build" --prefix "$work/prefix" >/dev/null

headers=$(cd "$work/prefix/include" && find . -name '*.hpp' -printf '%P\n' | sort)
count=$(wc -l <<<"$headers")
[ "$count" -le 24 ] || { echo "$count headers are installed, more than 24"; exit 1; }
for header in $headers; do
  printf '#include <%s>\nint main() {}\n' "$header" >"$work/header.cpp"
  g++ -std=c++20 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only \
    -isystem /usr/include/eigen3 -I"$work/prefix/include" "$work/header.cpp"
done
printf '#include <splinecast.h>\nint main(void) { return 0; }\n' >"$work/header.c"
for language in "-x c -std=c11" "-x c++ -std=c++20"; do
  # shellcheck disable=SC2086
  g++ $language -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only \
    -I"$work/prefix/include" "$work/header.c"
done
echo "$count installed headers and the one of C, each compiled alone"

cmake -S "$source/examples" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCMAKE_CXX_FLAGS="$warnings" >/dev/null
cmake --build "$work/cmake" --parallel 2 >/dev/null

# Requires that a project which finds the package with these words is configured, or that it fails
# with a message that has this text.
mkdir "$work/finder"
finds() {
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(finder LANGUAGES CXX)\n%s\n' \
    "find_package(splinecast 0.1 REQUIRED $1)" >"$work/finder/CMakeLists.txt"
  cmake -S "$work/finder" -B "$work/finder/build" -DCMAKE_PREFIX_PATH="$work/prefix" --fresh \
    "${@:3}" >"$work/finder/log" 2>&1 && found=yes || found=no
  [ "$found" = yes ] && [ -z "$2" ] && return
  [ "$found" = no ] && [ -n "$2" ] && tr -s ' \n' ' ' <"$work/finder/log" | grep -qF "$2" && return
  echo "find_package(splinecast $1) ${*:3}: found: $found, expected: ${2:-yes}"
  cat "$work/finder/log"
  exit 1
}
without_eigen=-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON
finds "" ""
finds "" "" $without_eigen
finds "COMPONENTS eigen" ""
finds "COMPONENTS eigen" "the component eigen needs Eigen3 3.4" $without_eigen
finds "OPTIONAL_COMPONENTS eigen quaternions" "" $without_eigen
finds "COMPONENTS eigen quaternions" "there is no component quaternions"
echo "The package finds its components"

pkg=$(find "$work/prefix" -name splinecast.pc -printf '%h')
flags=$(PKG_CONFIG_PATH=$pkg pkg-config --cflags --libs splinecast)
libraries=$(dirname "$(find "$work/prefix" -name 'libsplinecast.so')")
mkdir "$work/shared" "$work/static" "$work/pkg_config" "$work/out"
for example in "$source"/examples/[0-9]*_*.cpp; do
  name=$(basename "$example" .cpp)
  target=${name#*_}
  mv "$work/cmake/$target" "$work/shared/$name"
  mv "$work/cmake/${target}_static" "$work/static/$name"
  eigen=
  [ "$name" != 7_mpc_horizon ] || eigen=$(pkg-config --cflags eigen3)
  # shellcheck disable=SC2086
  g++ -std=c++20 $warnings "$example" $flags $eigen "-Wl,-rpath,$libraries" -o "$work/pkg_config/$name"
done

# The example in C, as C11.
mv "$work/cmake/c_producer" "$work/shared/8_producer"
mv "$work/cmake/c_producer_static" "$work/static/8_producer"
# shellcheck disable=SC2086
gcc -std=c11 -Wall -Wextra -Wpedantic -Werror "$source/examples/8_producer.c" $flags -lm \
  "-Wl,-rpath,$libraries" -o "$work/pkg_config/8_producer"

for shared in "$work"/shared/* "$work"/pkg_config/*; do
  objdump -p "$shared" | grep 'NEEDED *libsplinecast\.so\.0\.1$' >/dev/null ||
    { echo "$shared is not linked to libsplinecast.so.0.1"; exit 1; }
done

program=$work/prefix/bin/splinecast
streams=$(printf "$stream.%s " {shared,static,pkg_config}.{motion,redirect,refusals,override,override.law})

# Ends what still runs, and removes the streams that a failure has left.
clean_up() {
  jobs -p | xargs -r kill 2>/dev/null || true
  wait
  for name in $streams "$stream".{shared,static,pkg_config}_{pose,c}; do
    "$program" rm "$name" 2>/dev/null || true
  done
}
trap clean_up EXIT

# Starts an example of the current build on a stream, with further arguments. Its output goes to a file of its number.
start() {
  "$work/$linked/$1" "$stream.$linked$2" "${@:3}" >"$work/out/$1" 2>&1 &
  started+=($!)
}

# Requires that an example has printed a line that matches.
printed() {
  grep -Eqx "$2" "$work/out/$1" && return
  echo "$linked/$1 has not printed a line '$2', but:"
  cat "$work/out/$1"
  exit 1
}

"$program" solve "$stream.*.*" --quiet &
solver=$!
for linked in shared static pkg_config; do
  started=()
  start 2_controller .motion
  start 9_recorder .motion 1 "$work/out/recorded.csv"
  start 6_horizon _pose
  start 7_mpc_horizon _pose
  start 1_producer .motion
  start 3_embedded_solver _pose
  start 4_redirect .redirect
  start 5_refusals .refusals
  start 8_producer _c
  start 10_override .override
  for example in "${started[@]}"; do
    wait "$example" || { echo "an example with $linked has failed:"; cat "$work"/out/[13456789]*; exit 1; }
  done

  "$work/$linked/11_stop" "$stream.$linked.motion" 0.1 >"$work/out/11_stop" 2>&1 ||
    { echo "11_stop with $linked has failed:"; cat "$work/out/11_stop"; exit 1; }

  printed 11_stop "'$stream.$linked.motion' is released"
  printed 1_producer '[0-9]+ waypoints sent, [0-9]+ late, 0 refused'
  printed 2_controller 0.3  # where the motion begins
  [ "$(sort -u "$work/out/2_controller" | wc -l)" -gt 10 ] || { echo "2_controller saw no motion"; exit 1; }
  [ "$(wc -l <"$work/out/recorded.csv")" -gt 500 ] || { echo "9_recorder has few rows"; exit 1; }
  printed 3_embedded_solver '([0-9]+) of \1 items consumed, 0 refused'
  printed 10_override 'at most .* mm from the circle; .* s longer than at full rate'
  printed 4_redirect 'redirect in force at [0-9]* ns: entry; now at x = .* m/s'
  printed 4_redirect 'stop in force at [0-9]* ns: stop; now at x = .* m/s'
  printed 4_redirect 'at rest at x = .* m'
  printed 5_refusals 'row 1234 again: duplicate'
  for item in 500 1500 2500; do  # without its time if the ring has overwritten the item
    printed 5_refusals "item $item refused: quaternion of length 0( \\(time ${item}0000000 ns\\))?"
  done
  printed 6_horizon '[1-9][0-9]* horizons of 20 states, .*'
  printed 6_horizon 'nearest to a limit: velocity of dimension .*'
  printed 7_mpc_horizon '[1-9][0-9]* horizons of 50 states, tracking error 0\.05.* m, at the end 0\.000.* m, .*'
  printed 8_producer 'replacement accepted'
  printed 8_producer 'the fit passes 0.106, 0.106 m'
  echo "${#started[@]} examples, linked by $linked, have run"
done
kill "$solver"
wait "$solver"
# shellcheck disable=SC2086
"$program" rm $streams "$stream".{shared,static,pkg_config}_c
! "$program" ls | grep -F "$stream" || { echo "streams are left"; exit 1; }
