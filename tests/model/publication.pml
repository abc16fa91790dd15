/* Model of the publication in ipc/layout/publication.hpp: slots of two cells and two nodes, the ring of
 * changes, the commit word and the settled word; a writer that may die before any of its stores and is taken
 * over; a reader that keeps its copies.
 *
 * A tag is 2 · revision + the index of the cell's node. A revision leaves a slot unchanged, solves its knot
 * again (stores a tag and a cell) or stores a new knot in it (a tag, a node and a cell). Revision 0 holds
 * zeros. With two slots the reader needs both under one revision, as a segment needs its two knots.
 *
 * With CHANGES=N, slot 0 is the summary: every revision writes it, and it has no knot. The word of revision r
 * in the ring of changes is word r mod N.
 *
 * With SETTLED (not together with CHANGES), knot s is the curve at time s. The settled word S promises that
 * no later revision changes a slot s < S.
 *
 * Checked for every sequence of revisions:
 * - a copy that a reader accepts under revision r, made now or kept, holds the data of r;
 * - after the death of a writer a reader succeeds at the first try;
 * - the changes that a reader counts are those of the revisions that it missed;
 * - no revision after the one that a reader reads changes a slot that this reader calls settled.
 *
 * One word represents all words of a cell, and one all words of a node: the acceptance of a copy does not
 * depend on these words, so each of them must be right on its own. One reader represents any number, because
 * readers store nothing. A writer that discards its revision acts like the successor of a writer that died
 * just before the commit: it counts as one of LIVES.
 *
 * This checks the algorithm, not its memory orderings: the steps of writer and reader interleave one load or
 * store at a time, each thread in program order (sequential consistency). A missing release or acquire shows
 * neither here nor in a test on x86. The orderings have been checked separately, with litmus programs of the
 * same protocol: those of slots and commit word under the memory models RC11 and IMM, those of the ring of
 * changes and the settled word under RC11. publication.hpp justifies each of them.
 *
 * Each of these flags makes a mutant that must fail:
 * COMMIT_FIRST       stores the commit word before the slots
 * TAG_LAST           stores the tag after node and cell
 * CELL_FIRST         stores the cell before the tag
 * NODE_FIRST         stores the node before the tag
 * NODE_IN_PLACE      puts a new knot into the node of the newest cell
 * NODE_OF_DEAD       uses the node of the greatest tag, committed or not
 * LIVE_CELL          writes the newest cell, not the spare one
 * NO_RETIRE          the successor does not retire tags that no commit has made visible
 * RETIRE_WITH_ZERO   the successor retires them as the oldest tags, not as the newest
 * DISCARD_IN_PLACE   a writer that discards its revision leaves its tags
 * NO_RECHECK         the reader does not load the tag again after the copy
 * KEEP_UNSEEN        uses a kept copy without loading its tags
 * KEEP_OWN           loads only the tag of the copy's own cell
 * KEEP_OWN_FIRST     loads it before the tag of the other cell
 * KEEP_AT_ONCE       finds the newest cell from both tags in storage order, as if loaded at one instant
 * KEEP_NODE          copies only the cell again if the new tag has the same node bit
 * CHANGE_FIRST       stores the word of the ring before the tag of the summary
 * CHANGES_LIMIT=N    counts the changes if the greatest tag is at most N, not N - 1, above the revision seen:
 *                    fails if a writer has died and its tag has been retired
 * CHANGES_UNTAGGED   counts them also if both tags are retired: fails if a successor dies as well, and is
 *                    taken over, between the loads of the tags
 * TAGS_BEFORE_WORDS  loads the tags of the summary before the words of the ring
 * SETTLED_EARLY      stores the settled word of a revision before its commit
 * SETTLED_LATE       the reader loads the settled word after the commit word
 * SETTLED_FORGOTTEN  the successor does not continue from the settled word that it finds */

#ifndef LAST
#define LAST 3 /* the last revision */
#endif
#ifndef LIVES
#define LIVES 2 /* writers, one after the other */
#endif
#ifndef SLOTS
#define SLOTS 1 /* 1 or 2 */
#endif
#ifndef TRIES
#define TRIES 2 /* of the reader, before the one at the end */
#endif
#define NONE 255 /* no tag */
#ifdef RETIRE_WITH_ZERO
#define RETIRED 0
#else
#define RETIRED 254
#endif

byte revision;
byte tag[2 * SLOTS]; /* [2 · slot + cell] */
byte cell[2 * SLOTS];
byte node[2 * SLOTS]; /* [2 · slot + node] */
#ifdef CHANGES
byte change[CHANGES];
#ifndef CHANGES_LIMIT
#define CHANGES_LIMIT (CHANGES - 1)
#endif
#endif
#ifdef SETTLED
byte settled;
#endif
bool over; /* no writer is alive, and none will follow */

/* For assertions only: the data of the committed revision, and the promises to readers. */
byte held_cell[SLOTS];
byte held_node[SLOTS];
#ifdef CHANGES
byte held_change[LAST + 1]; /* of each revision */
#endif
#ifdef SETTLED
byte promised; /* the greatest settled word that a reader has used */
#endif

/* The cell that is newest under r, of a slot whose tags are t0 and t1. */
#define NEWEST(t0, t1, r) (((t1) / 2 <= (r) && ((t0) / 2 > (r) || (t1) > (t0))) -> 1 : 0)

/* One store; the writer may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

mtype = { leave, again, fresh }

#ifdef LIVE_CELL
#define TARGET live
#else
#define TARGET (1 - live)
#endif
#ifdef NODE_OF_DEAD
#define CURRENT (tag[2 * s] > tag[2 * s + 1] -> tag[2 * s] : tag[2 * s + 1])
#else
#define CURRENT tag[2 * s + live]
#endif
#ifdef NODE_IN_PLACE
#define NODE_OF_NEXT (CURRENT % 2)
#else
#define NODE_OF_NEXT (plan[s] == fresh -> 1 - CURRENT % 2 : CURRENT % 2)
#endif

#ifdef SETTLED_FORGOTTEN
#define FROZEN (life > 1 -> 0 : settled)
#elif defined SETTLED
#define FROZEN settled
#else
#define FROZEN 0
#endif

#define STORE_TAG STORE(tag[2 * s + c], 2 * r + m) /* W1 */
#define STORE_NODE \
  if \
  :: plan[s] == fresh -> STORE(node[2 * s + m], value) /* W2 */ \
  :: else \
  fi
#ifdef CHANGES
#define IS_HEAD(s) (s == 0)
#define STORE_CHANGE \
  if \
  :: IS_HEAD(s) -> STORE(change[r % CHANGES], value) /* C1 */ \
  :: else \
  fi
#else
#define IS_HEAD(s) false
#define STORE_CHANGE skip
#endif
#define STORE_CELL STORE(cell[2 * s + c], value) /* W2 */

#ifdef CHANGES
#define HOLD_CHANGE held_change[r] = value
#else
#define HOLD_CHANGE skip
#endif
#ifdef SETTLED
#define ASSERT_NOT_PROMISED assert(s >= promised)
#else
#define ASSERT_NOT_PROMISED skip
#endif
#ifdef DISCARD_IN_PLACE
#define DISCARD :: life < LIVES -> life++; goto next_revision
#else
#define DISCARD
#endif

/* Resets the variables of a revision that is committed or lost: fewer states. */
#define FORGET s = 0; c = 0; m = 0; r = 0; value = 0; plan[0] = leave; plan[SLOTS - 1] = leave
#ifdef COMMIT_FIRST
#define COMMITTED s = 0
#else
#define COMMITTED FORGET
#endif
#define COMMIT \
  if \
  :: d_step { \
       revision = r; \
       HOLD_CHANGE; \
       s = 0; \
       do \
       :: s < SLOTS && plan[s] == leave -> s++ \
       :: s < SLOTS && plan[s] != leave -> \
          ASSERT_NOT_PROMISED; \
          held_cell[s] = value; \
          held_node[s] = (plan[s] == fresh -> value : held_node[s]); \
          s++ \
       :: s == SLOTS -> break \
       od; \
       COMMITTED; \
     } \
  :: goto died \
  DISCARD \
  fi

proctype Writer() {
  byte life, r, s, c, m, live, value;
  mtype plan[SLOTS];

next_life:
  life++;
#ifndef NO_RETIRE
  do /* T1 */
  :: s < 2 * SLOTS ->
     if
     :: tag[s] / 2 > revision && tag[s] != RETIRED -> STORE(tag[s], RETIRED); s++
     :: else -> s++
     fi
  :: else -> break
  od;
#endif
next_revision:
  do
#ifdef SETTLED
  :: FROZEN < SLOTS -> STORE(settled, FROZEN + 1) /* S1: for this revision, or a later one */
#endif
  :: atomic {
       revision < LAST ->
       r = revision + 1;
       value = 10 * life + r;
       s = 0;
       do
       :: s < SLOTS ->
          if
          :: s >= FROZEN -> plan[s] = again
          :: !IS_HEAD(s) -> plan[s] = leave
          :: !IS_HEAD(s) && s >= FROZEN -> plan[s] = fresh
          fi;
          s++
       :: s == SLOTS -> s = 0; break
       od
     };
#ifdef COMMIT_FIRST
     COMMIT;
#endif
     do
     :: s < SLOTS && plan[s] == leave -> s++
     :: atomic {
          s < SLOTS && plan[s] != leave ->
          live = NEWEST(tag[2 * s], tag[2 * s + 1], r - 1); /* W0 */
          m = NODE_OF_NEXT;
          c = TARGET;
          live = 0
        };
#if defined TAG_LAST
        STORE_NODE; STORE_CELL; STORE_TAG;
#elif defined CELL_FIRST
        STORE_CELL; STORE_TAG; STORE_NODE;
#elif defined CHANGE_FIRST
        STORE_CHANGE; STORE_TAG; STORE_NODE; STORE_CELL;
#elif defined NODE_FIRST
        STORE_NODE; STORE_TAG; STORE_CELL;
#else
        STORE_TAG;
        STORE_CHANGE;
        STORE_NODE;
        STORE_CELL;
#endif
        s++
     :: s == SLOTS -> break
     od;
#ifdef SETTLED_EARLY
     STORE(settled, SLOTS);
#endif
#ifndef COMMIT_FIRST
     COMMIT /* W3 */
#endif
  :: revision == LAST -> break
  od;
  goto ended;
died:
  atomic { FORGET };
  if
  :: life < LIVES -> goto next_life
  :: life == LIVES
  fi;
ended:
  over = true
}

/* Skips to the next slot if the kept copy of this one holds the data of r, else drops the copy. */
#ifdef KEEP_NODE
#define DROP skip
#else
#define DROP atomic { t0 = 0; t1 = 0; kept_tag[s] = NONE; kept_cell[s] = 0; kept_node[s] = 0 }
#endif
#define KEEP_IF(is_current) if :: is_current -> goto next_slot :: else -> DROP fi
#define OTHER_IS_OLD(other) (other / 2 > r || other < kept_tag[s])
#if defined KEEP_UNSEEN
#define KEEP KEEP_IF(true)
#elif defined KEEP_OWN
#define KEEP t1 = tag[2 * s + c]; KEEP_IF(t1 == kept_tag[s])
#elif defined KEEP_AT_ONCE
#define KEEP t0 = tag[2 * s]; t1 = tag[2 * s + 1]; KEEP_IF((NEWEST(t0, t1, r) -> t1 : t0) == kept_tag[s])
#elif defined KEEP_OWN_FIRST
#define KEEP \
  t1 = tag[2 * s + c]; t0 = tag[2 * s + 1 - c]; KEEP_IF(OTHER_IS_OLD(t0) && t1 == kept_tag[s])
#else
#define KEEP /* K1 and K2 */ \
  t0 = tag[2 * s + 1 - c]; t1 = tag[2 * s + c]; KEEP_IF(OTHER_IS_OLD(t0) && t1 == kept_tag[s])
#endif

/* The revision of the greatest tag of the summary that is not retired; if both are, one too high to count. */
#ifdef CHANGES_UNTAGGED
#define UNTAGGED 0
#else
#define UNTAGGED NONE
#endif
#define GREATEST(t0, t1) \
  (t0 == RETIRED && t1 == RETIRED -> UNTAGGED : \
   (t1 == RETIRED || t0 != RETIRED && t0 > t1 -> t0 / 2 : t1 / 2))

proctype Reader() {
  byte try, r, s, c, t0, t1;
  byte kept_tag[SLOTS], kept_cell_index[SLOTS], kept_cell[SLOTS], kept_node[SLOTS];
  byte r_cell[SLOTS], r_node[SLOTS]; /* the data of r */
  bool whole, last;
#ifdef CHANGES
  byte seen, q;
  bool right; /* the words are those of the revisions missed */
#endif
#ifdef SETTLED
  byte calls_settled;
#endif

  atomic {
    do
    :: s < SLOTS -> kept_tag[s] = NONE; s++
    :: else -> break
    od
  };
  do
  :: atomic {
       try < TRIES || over ->
#if defined SETTLED && !defined SETTLED_LATE
       calls_settled = settled; /* S2 */
#endif
       last = over /* no writer stores during this try */
     };
     d_step {
       r = revision; /* R1 */
       whole = true;
       s = 0;
       do
       :: s < SLOTS -> r_cell[s] = held_cell[s]; r_node[s] = held_node[s]; s++
       :: s == SLOTS -> break
       od;
       s = 0;
     };
#ifdef SETTLED
     d_step {
#ifdef SETTLED_LATE
       calls_settled = settled;
#endif
       do
       :: s < calls_settled -> assert(held_cell[s] == r_cell[s] && held_node[s] == r_node[s]); s++
       :: else -> break
       od;
       promised = (calls_settled > promised -> calls_settled : promised);
       calls_settled = 0;
       s = 0;
     };
#endif
#ifdef CHANGES
#ifdef TAGS_BEFORE_WORDS
     t0 = tag[0];
     t1 = tag[1];
#endif
     atomic { q = seen + 1; right = true };
     do
     :: q <= r -> right = right && change[q % CHANGES] == held_change[q]; q++ /* C2 */
     :: else -> break
     od;
#ifndef TAGS_BEFORE_WORDS
     t0 = tag[0]; /* C3 */
     t1 = tag[1];
#endif
     atomic {
       t0 = GREATEST(t0, t1);
       assert(right || t0 > seen + CHANGES_LIMIT);
       assert(!last || t0 <= seen + CHANGES_LIMIT || r + 1 > seen + CHANGES_LIMIT); /* else never useful */
       seen = r;
       q = 0;
       right = false;
       t0 = 0;
       t1 = 0
     };
#endif
     do
     :: s < SLOTS && whole ->
        c = kept_cell_index[s];
        if
        :: kept_tag[s] != NONE -> KEEP
        :: else
        fi;
        t0 = tag[2 * s]; /* R2 */
        t1 = tag[2 * s + 1];
        d_step { c = NEWEST(t0, t1, r); t0 = (c -> t1 : t0); t1 = 0 };
        if
        :: t0 / 2 > r -> whole = false; goto next_slot
        :: else
        fi;
        kept_cell[s] = cell[2 * s + c]; /* R3 */
#ifdef KEEP_NODE
        if
        :: kept_tag[s] == NONE || kept_tag[s] % 2 != t0 % 2 -> kept_node[s] = node[2 * s + t0 % 2]
        :: else
        fi;
#else
        kept_node[s] = node[2 * s + t0 % 2];
#endif
        kept_tag[s] = t0;
        kept_cell_index[s] = c;
#ifndef NO_RECHECK
        whole = (tag[2 * s + c] == t0); /* R4 */
#endif
next_slot:
        atomic { /* resets variables that are no longer needed: fewer states */
          if
          :: !whole -> kept_tag[s] = NONE; kept_cell_index[s] = 0; kept_cell[s] = 0; kept_node[s] = 0
          :: whole
          fi;
          t0 = 0;
          t1 = 0;
          c = 0;
          assert(!whole || kept_cell[s] == r_cell[s] && kept_node[s] == r_node[s]);
          r_cell[s] = 0;
          r_node[s] = 0;
          s++
        }
     :: else -> break
     od;
     atomic {
       assert(!last || whole);
       r_cell[SLOTS - 1] = 0;
       r_node[SLOTS - 1] = 0;
       s = 0;
       r = 0;
       try = (try < TRIES -> try + 1 : try);
     };
     if
     :: last -> break
     :: else
     fi
  od
}

init {
  atomic { run Writer(); run Reader() }
}
