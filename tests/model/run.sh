#!/usr/bin/env bash
# Checks the models of this folder exhaustively with spin, and that each mutant of them is caught.
#   run.sh BUILD [DEFINE…]   DEFINE is passed to every search that sets no bound itself: -DLAST=4 -DLIVES=3
# Prints how many states each search stored. Exits with 77 if spin or cc is missing.
set -euo pipefail
source=$(cd "$(dirname "$0")" && pwd)
build=$1
shift
for tool in spin cc; do
  command -v "$tool" >/dev/null || { echo "$tool is not on this machine: the models are not checked"; exit 77; }
done

# Searches all states of a model up to the first error; writes the result to pan.log.
level=-O1
search() {  # model, flags…
  spin "${@:2}" -a "$source/$1.pml" >spin.log || { cat spin.log; exit 1; }
  cc "$level" -w -DSAFETY -o pan pan.c
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
  level=-O0 search "$1" "-D$2" "${@:3}"  # compiles faster; most fail after few states
  grep -q 'assertion violated' pan.log || { cat pan.log; echo "$1: the mutant $2 is not caught"; exit 1; }
  echo "$1 -D$2: caught after $(states) states"
}

mkdir -p "$build"
cd "$build"
holds publication "$@"
for mutant in COMMIT_FIRST TAG_LAST CELL_FIRST NODE_FIRST NODE_IN_PLACE NODE_OF_DEAD LIVE_CELL NO_RETIRE \
              RETIRE_WITH_ZERO DISCARD_IN_PLACE NO_RECHECK KEEP_UNSEEN KEEP_OWN KEEP_NODE; do
  fails publication "$mutant" "$@"
done
holds publication -DLIVES=3  # a successor that dies too
holds publication -DSLOTS=2 -DLAST=2 -DTRIES=1
# Kept copies: enough revisions for two commits between the loads of two tags.
holds publication -DLAST=4
holds publication -DLAST=5 -DLIVES=1
for mutant in KEEP_OWN_FIRST KEEP_AT_ONCE; do
  fails publication "$mutant" -DLAST=4
done
# The ring of changes, and the settled word.
holds publication -DCHANGES=3 -DLAST=5
holds publication -DCHANGES=2 -DLAST=5 -DLIVES=3 -DTRIES=1
fails publication CHANGE_FIRST -DCHANGES=3 -DLAST=5
fails publication CHANGES_LIMIT=2 -DCHANGES=2
fails publication CHANGES_UNTAGGED -DCHANGES=2 -DLAST=5 -DLIVES=3 -DTRIES=1
fails publication TAGS_BEFORE_WORDS -DCHANGES=2
holds publication -DSETTLED "$@"
holds publication -DSETTLED -DSLOTS=2 -DLAST=2 -DTRIES=1 -DLIVES=1
for mutant in SETTLED_EARLY SETTLED_LATE SETTLED_FORGOTTEN; do
  fails publication "$mutant" -DSETTLED "$@"
done
holds waypoint_ring "$@"
for mutant in HEAD_FIRST TAIL_FIRST OBSERVER_LE NO_CLAIM NO_SECOND_LOOK NO_WAKE; do
  fails waypoint_ring "$mutant" "$@"
done
# Refusals and excesses of a lost revision.
holds lost_records "$@"
holds lost_records -DREFUSALS "$@"
holds lost_records -DSTOPS -DLIVES=2
for mutant in NO_CLEAR CLEAR_LATE CLEAR_FIRST_ONLY STOP_AT_CLEARED NO_ZERO NO_RECHECK; do
  fails lost_records "$mutant" "$@"
done
for mutant in NO_CLEAR CLEAR_WITH_ZERO; do
  fails lost_records "$mutant" -DREFUSALS "$@"
done
fails lost_records ITEM_ALONE -DSTOPS -DLIVES=2
holds commander_record "$@"
for mutant in BEFORE_ONLY AFTER_ONLY TAKE_ODD ODD_OF_DEAD NO_SECOND_LOAD; do
  fails commander_record "$mutant" "$@"
done
holds lowered_settled "$@"
for mutant in LOWER_LAST NO_SECOND_LOOK SETTLED_FIRST; do
  fails lowered_settled "$mutant" "$@"
done
