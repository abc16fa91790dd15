#!/usr/bin/env bash
# Checks the models of this folder exhaustively with spin, and that each mutant of them is caught.
#   run.sh BUILD [DEFINE…]   DEFINE is given to every model: -DLAST=4 -DLIVES=3 for larger bounds
# Says of each how many states were stored. Exits with 77 if spin or cc is missing.
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
build=$1
shift
for tool in spin cc; do
  command -v "$tool" >/dev/null || { echo "$tool is not on this machine: the models are not checked"; exit 77; }
done

# Searches all states of a model, stopping at the first error; leaves what was found in pan.log.
search() {  # model, flags…
  spin "${@:2}" -a "$source/$1.pml" >spin.log || { cat spin.log; exit 1; }
  cc -O1 -w -DSAFETY -o pan pan.c
  ./pan -m100000 >pan.log
  if grep -q 'Search not completed\|max search depth too small' pan.log && grep -q 'errors: 0' pan.log; then
    echo "$*: the search is not complete"
    exit 1
  fi
}

states() { awk '/states, stored/ { print $1; exit }' pan.log; }

holds() {  # model, flags…
  search "$@"
  grep -q 'errors: 0' pan.log || { cat pan.log; echo "$*: fails"; exit 1; }
  echo "$*: holds in $(states) states"
}

fails() {  # model, mutant, flags…
  search "$1" "-D$2" "${@:3}"
  grep -q 'assertion violated' pan.log || { cat pan.log; echo "$1: the mutant $2 is not caught"; exit 1; }
  echo "$1 -D$2: caught after $(states) states"
}

mkdir -p "$build"
cd "$build"
holds publication "$@"
for mutant in COMMIT_FIRST TAG_LAST LIVE_CELL NO_RETIRE NO_RECHECK KEEP_UNSEEN KEEP_OWN; do
  fails publication "$mutant" "$@"
done
# Kept copies: one slot, and revisions enough for two to pass between the loads of two tags.
holds publication -DSLOTS=1 -DLAST=5
for mutant in KEEP_AT_ONCE KEEP_OWN KEEP_OWN_FIRST KEEP_PART; do
  fails publication "$mutant" -DSLOTS=1 -DLAST=5
done
holds waypoint_ring "$@"
for mutant in HEAD_FIRST TAIL_FIRST OBSERVER_LE NO_CLAIM NO_SECOND_LOOK NO_WAKE; do
  fails waypoint_ring "$mutant" "$@"
done
