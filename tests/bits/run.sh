#!/usr/bin/env bash
# Builds library, solver and reader with -O0 for any x86-64, with -O3 -march=native (kernels are also
# compiled for AVX2) and with clang. Checks that every reader gets the same bits from every writer's
# stream.
#   run.sh SOURCE BUILD
set -euo pipefail
source=$1
build=$2
stream=test.$$.bits

configure() {  # name, compiler, flags
  cmake -S "$source" -B "$build/$1" -G Ninja -DCMAKE_CXX_COMPILER="$2" -DCMAKE_CXX_FLAGS="$3" \
    -DSPLINECAST_BUILD_APPS=OFF -DSPLINECAST_BUILD_TESTS=OFF -DSPLINECAST_BUILD_BENCH=OFF \
    -DSPLINECAST_BUILD_BITS=ON -DSPLINECAST_UNITY=ON >/dev/null
  cmake --build "$build/$1" --target splinecast_bits >"$build/$1.log" 2>&1 ||
    { cat "$build/$1.log"; exit 1; }
}

mkdir -p "$build"
variants="O0 native"
configure O0 g++ "-O0 -DSPLINECAST_NO_VECTOR_CLONES"
configure native g++ "-O3 -march=native"
if command -v clang++ >/dev/null; then
  configure clang clang++ "-O2"
  variants="$variants clang"
else
  echo "clang++ is not on this machine: only the builds of gcc are compared"
fi

hashes=""
for writer in $variants; do
  "$build/$writer/bin/splinecast_bits" write "$stream"
  for reader in $variants; do
    hash=$("$build/$reader/bin/splinecast_bits" read "$stream")
    echo "written by $writer, read by $reader: $hash"
    hashes="$hashes $hash"
  done
  "$build/$writer/bin/splinecast_bits" remove "$stream"
done
[ "$(tr ' ' '\n' <<<"$hashes" | sed '/^$/d' | sort -u | wc -l)" = 1 ]
