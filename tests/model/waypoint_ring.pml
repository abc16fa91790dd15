/* Model of the ring in ipc/ring/writer.hpp: a producer that appends one or several items by one store of
 * `written`, may die at any store and is taken over; a solver that consumes, sleeps and is woken; and a passive
 * observer that no process waits for. Steps interleave one load or store at a time, in program order: this
 * checks the algorithm, not its memory orderings.
 *
 * One observer that reads once represents any number: observers store nothing and remember nothing.
 *
 * Checked: the solver reads every item whole and in order; the observer keeps no item that was, or was being,
 * overwritten; and the solver does not stay asleep while an item waits (that is an invalid end state).
 *
 * Each of these flags makes a mutant that must fail: HEAD_FIRST, TAIL_FIRST, OBSERVER_LE, NO_CLAIM,
 * NO_SECOND_LOOK, NO_WAKE. */

#ifndef LAST
#define LAST 4 /* total number of items */
#endif
#ifndef LIVES
#define LIVES 2 /* producers, one after the other */
#endif
#define CAPACITY 2

byte written, claimed; /* the producer's region */
byte word0[CAPACITY];
byte word1[CAPACITY];
byte consumed;          /* the solver's region */
bool sleeping;
bool asleep;        /* the solver is in the kernel, waiting on `written` */

/* For assertions only: the value of item i when `written` made it visible. */
byte item[LAST];

/* One store; the producer may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

#define PUBLISH \
  if \
  :: d_step { \
       k = 0; \
       do \
       :: k < count -> item[written + k] = 10 * life + written + k; k++ \
       :: else -> break \
       od; \
       written = written + count; \
     } \
  :: goto died \
  fi

proctype Producer() {
  byte life, count, k, at;

next_life:
  life++;
  do
  :: written < LAST ->
     if /* an append, or a replacement with its waypoints */
     :: count = 1
     :: written + 2 <= LAST -> count = 2
     fi;
     written + count - consumed <= CAPACITY; /* else `full`: tried again later */
#ifndef NO_CLAIM
     if
     :: count > 1 -> STORE(claimed, written + count)
     :: else
     fi;
#endif
     at = written;
#ifdef HEAD_FIRST
     PUBLISH;
#endif
     k = 0;
     do
     :: k < count ->
        STORE(word0[(at + k) % CAPACITY], 10 * life + at + k);
        STORE(word1[(at + k) % CAPACITY], 10 * life + at + k);
        k++
     :: else -> break
     od;
#ifndef HEAD_FIRST
     PUBLISH;
#endif
     if
     :: sleeping ->
#ifndef NO_WAKE
        asleep = false /* futex wake */
#else
        skip
#endif
     :: !sleeping
     fi
  :: written == LAST -> break
  od;
  goto ended;
died:
  asleep = false; /* a sleep ends after one slice, so that a wake lost with its producer only delays */
  if
  :: life < LIVES -> goto next_life
  :: life == LIVES -> goto ended
  fi;
ended:
  skip
}

proctype Solver() {
  byte seen, h, c0, c1;

  do
  :: h = written;
     do
     :: seen < h ->
#ifdef TAIL_FIRST
        consumed = seen + 1;
#endif
        c0 = word0[seen % CAPACITY];
        c1 = word1[seen % CAPACITY];
        assert(c0 == item[seen] && c1 == item[seen]);
        seen++
     :: else -> break
     od;
#ifndef TAIL_FIRST
     consumed = seen;
#endif
     sleeping = true;
     h = written;
     if
#ifdef NO_SECOND_LOOK
     :: true ->
#else
     :: h == seen ->
#endif
        atomic { /* futex wait: the kernel compares and sleeps atomically */
          if
          :: written == h -> asleep = true
          :: else
          fi
        };
end_asleep:
        !asleep
#ifndef NO_SECOND_LOOK
     :: else
#endif
     fi;
     sleeping = false
  od
}

proctype Observer() {
  byte i, c0, c1, h, cl;

end_waiting:
  written > 0;
  if /* the newest item, or the one before it */
  :: i = written - 1
  :: written > 1 -> i = written - 2
  fi;
  c0 = word0[i % CAPACITY];
  c1 = word1[i % CAPACITY];
  h = written;
  cl = claimed;
  if
#ifdef OBSERVER_LE
  :: h <= i + CAPACITY && cl <= i + CAPACITY ->
#else
  :: h < i + CAPACITY && cl <= i + CAPACITY ->
#endif
     assert(c0 == item[i] && c1 == item[i])
  :: else
  fi
}

/* When no process can take a step, the solver has consumed every item. */
active proctype Rest() {
  timeout;
  assert(consumed == written)
}

init {
  atomic { run Producer(); run Solver(); run Observer() }
}
