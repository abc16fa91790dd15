/* The publication of ipc/publication.hpp: slots of two cells, a commit word, a writer that dies at any
 * store and is taken over, and a reader that keeps what it copied. Steps interleave one load or store at a
 * time, in program order: this checks the algorithm, not its memory orderings.
 *
 * One reader stands for any number: readers store nothing, so that none can disturb another. A revision
 * changes any choice of slots. A revision that its own writer discards is the case of a writer that dies
 * before the commit.
 *
 * Held: what a reader accepts under revision r, copied now or kept from before, is in every slot what r
 * holds, whole; and whatever a dead writer left can be read, at the first try.
 *
 * Each of these flags makes a mutant that must fail: COMMIT_FIRST, TAG_LAST, LIVE_CELL, NO_RETIRE,
 * NO_RECHECK. Those that begin with KEEP weaken the check of a kept copy: KEEP_UNSEEN has none,
 * KEEP_AT_ONCE finds the newest cell from both tags as seen once, KEEP_OWN looks at the copy's own
 * tag alone, KEEP_OWN_FIRST at it before the other one, KEEP_PART keeps the first word and copies
 * the second one again. All but KEEP_UNSEEN and KEEP_OWN need several revisions of one slot:
 * one slot and LAST=5 have them in few states. */

#ifndef LAST
#define LAST 3 /* the last revision */
#endif
#ifndef LIVES
#define LIVES 2 /* writers, one after the other */
#endif
#ifndef SLOTS
#define SLOTS 2 /* 1 or 2 */
#endif
#define TRIES 2 /* of the reader, before the one at the end */
#define RETIRED 255

byte revision;
byte tag[4];   /* [slot · 2 + cell] */
byte word0[4]; /* two words of each cell */
byte word1[4];
bool over;     /* no writer lives, and none will come */

/* What revision r holds in a slot, noted at its commit: [r · 2 + slot]. No reader acts on it. */
byte holds[SLOTS * (LAST + 1)];

/* The cell that is newest under r, of a slot whose tags are t0 and t1. */
#define NEWEST(t0, t1, r) (((t1) <= (r) && ((t0) > (r) || (t1) > (t0))) -> 1 : 0)

/* One store; the writer may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

#ifdef LIVE_CELL
#define TARGET(s, r) ((s) * 2 + NEWEST(tag[(s) * 2], tag[(s) * 2 + 1], r))
#else
#define TARGET(s, r) ((s) * 2 + 1 - NEWEST(tag[(s) * 2], tag[(s) * 2 + 1], r))
#endif

#define HOLD(r, s, value) \
  holds[(r) * SLOTS + (s)] = (changes[s] -> value : holds[((r) - 1) * SLOTS + (s)])
#if SLOTS == 2
#define HOLD_SECOND(r, value) HOLD(r, 1, value)
#else
#define HOLD_SECOND(r, value) skip
#endif

#define COMMIT(r, value) \
  if \
  :: d_step { revision = r; HOLD(r, 0, value); HOLD_SECOND(r, value); } \
  :: goto died \
  fi

proctype Writer() {
  byte life, r, s, c, value;
  bool changes[SLOTS];

next_life:
  life++;
  s = 0;
#ifndef NO_RETIRE
  do /* T1: what no commit has made visible is retired */
  :: s < 2 * SLOTS && tag[s] > revision && tag[s] != RETIRED -> STORE(tag[s], RETIRED); s++
  :: s < 2 * SLOTS && !(tag[s] > revision && tag[s] != RETIRED) -> s++
  :: s == 2 * SLOTS -> break
  od;
#endif
  do
  :: revision < LAST ->
     d_step { r = revision + 1; value = 10 * life + r; }
     if /* the slots that this revision changes; the first one, all */
#if SLOTS == 2
     :: r > 1 -> changes[0] = true; changes[1] = false
     :: r > 1 -> changes[0] = false; changes[1] = true
     :: changes[0] = true; changes[1] = true
#else
     :: r > 1 -> changes[0] = false
     :: changes[0] = true
#endif
     fi;
#ifdef COMMIT_FIRST
     COMMIT(r, value);
#endif
     s = 0;
     do
     :: s < SLOTS && !changes[s] -> s++
     :: s < SLOTS && changes[s] ->
        c = TARGET(s, r - 1);
#ifndef TAG_LAST
        STORE(tag[c], r); /* W1 */
#endif
        STORE(word0[c], value); /* W2 */
        STORE(word1[c], value);
#ifdef TAG_LAST
        STORE(tag[c], r);
#endif
        s++
     :: s == SLOTS -> break
     od;
#ifndef COMMIT_FIRST
     COMMIT(r, value); /* W3 */
#endif
  :: revision == LAST -> break
  od;
  goto ended;
died:
  if
  :: life < LIVES -> goto next_life
  :: life == LIVES
  fi;
ended:
  over = true
}

/* K1 and K2: goes to the next slot if the copy kept of this one, made from cell c, is what r holds. */
#define OTHER_IS_OLD(other, s, r) (other > r || other < kept_tag[s])
#if defined KEEP_UNSEEN
#define KEEP(s, c, r, t0, t1) goto next_slot
#elif defined KEEP_PART
#define KEEP(s, c, r, t0, t1) skip
#elif defined KEEP_AT_ONCE
#define KEEP(s, c, r, t0, t1) \
  t0 = tag[(s) * 2]; t1 = tag[(s) * 2 + 1]; \
  if :: (NEWEST(t0, t1, r) -> t1 : t0) == kept_tag[s] -> goto next_slot :: else fi
#elif defined KEEP_OWN
#define KEEP(s, c, r, t0, t1) \
  if :: tag[(s) * 2 + c] == kept_tag[s] -> goto next_slot :: else fi
#elif defined KEEP_OWN_FIRST
#define KEEP(s, c, r, t0, t1) \
  t1 = tag[(s) * 2 + c]; t0 = tag[(s) * 2 + 1 - c]; \
  if :: OTHER_IS_OLD(t0, s, r) && t1 == kept_tag[s] -> goto next_slot :: else fi
#else
#define KEEP(s, c, r, t0, t1) \
  t0 = tag[(s) * 2 + 1 - c]; t1 = tag[(s) * 2 + c]; \
  if :: OTHER_IS_OLD(t0, s, r) && t1 == kept_tag[s] -> goto next_slot :: else fi
#endif

proctype Reader() {
  byte try, r, s, c, t0, t1;
  byte kept_tag[SLOTS], kept_cell[SLOTS], kept0[SLOTS], kept1[SLOTS];
  bool whole, last;

  do
  :: try < TRIES || over ->
     last = over; /* no writer stores during this try */
     r = revision; /* R1 */
     whole = (r > 0);
     s = 0;
     do
     :: s < SLOTS && whole ->
        if
        :: kept_tag[s] != 0 -> KEEP(s, kept_cell[s], r, t0, t1)
        :: else
        fi;
        t0 = tag[s * 2]; /* R2 */
        t1 = tag[s * 2 + 1];
        c = NEWEST(t0, t1, r);
        if
        :: t0 > r && t1 > r -> whole = false; goto next_slot
        :: else
        fi;
#ifdef KEEP_PART
        if
        :: kept_tag[s] == 0 -> kept0[s] = word0[s * 2 + c]
        :: else
        fi;
#else
        kept0[s] = word0[s * 2 + c]; /* R3 */
#endif
        kept_tag[s] = 0;
        kept1[s] = word1[s * 2 + c];
#ifndef NO_RECHECK
        whole = (tag[s * 2 + c] == (c -> t1 : t0)); /* R4 */
#endif
        if
        :: whole -> kept_tag[s] = (c -> t1 : t0); kept_cell[s] = c
        :: else
        fi;
next_slot:
        atomic { /* forgets what it needs no more: fewer states */
          t0 = 0;
          t1 = 0;
          c = 0;
          kept0[s] = (whole -> kept0[s] : 0);
          kept1[s] = (whole -> kept1[s] : 0);
          s++
        }
     :: else -> break
     od;
     s = 0;
     d_step {
       do
       :: s < SLOTS && whole ->
          assert(kept0[s] == holds[r * SLOTS + s] && kept1[s] == holds[r * SLOTS + s]);
          s++
       :: else -> break
       od;
       assert(!last || whole || r == 0);
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
