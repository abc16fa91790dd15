/* The hand-over of ipc/ring/writer.hpp: a producer that appends items singly or several by one store of
 * `head`, dies at any store and is taken over; a solver that consumes, sleeps and is woken; and a passive
 * observer that nobody waits for. Steps interleave one load or store at a time, in program order: this
 * checks the algorithm, not its memory orderings.
 *
 * One observer and one look stand for any number: observers store nothing and remember nothing.
 *
 * Held: the solver reads every item whole and in order; the observer keeps no item that was, or was being,
 * overwritten; and the solver never sleeps on while an item waits (an end state that is none).
 *
 * Each of these flags makes a mutant that must fail: HEAD_FIRST, TAIL_FIRST, OBSERVER_LE, NO_CLAIM,
 * NO_SECOND_LOOK, NO_WAKE. */

#ifndef LAST
#define LAST 4 /* items in all */
#endif
#ifndef LIVES
#define LIVES 2 /* producers, one after the other */
#endif
#define CAPACITY 2

byte head, claimed; /* the producer's region */
byte word0[CAPACITY];
byte word1[CAPACITY];
byte tail;          /* the solver's region */
bool sleeping;
bool asleep;        /* the solver is in the kernel, waiting on `head` */

/* What item i was when `head` made it visible. Nobody acts on it. */
byte item[LAST];

/* One store; the producer may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

#define PUBLISH \
  if \
  :: d_step { \
       k = 0; \
       do \
       :: k < count -> item[head + k] = 10 * life + head + k; k++ \
       :: else -> break \
       od; \
       head = head + count; \
     } \
  :: goto died \
  fi

proctype Producer() {
  byte life, count, k, at;

next_life:
  life++;
  do
  :: head < LAST ->
     if /* an append, or a replacement with its waypoints */
     :: count = 1
     :: head + 2 <= LAST -> count = 2
     fi;
     head + count - tail <= CAPACITY; /* else `full`: tried again later */
#ifndef NO_CLAIM
     if
     :: count > 1 -> STORE(claimed, head + count)
     :: else
     fi;
#endif
     at = head;
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
  :: head == LAST -> break
  od;
  goto ended;
died:
  asleep = false; /* no sleep lasts longer than a slice: a wake that died with its producer is made up for */
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
  :: h = head;
     do
     :: seen < h ->
#ifdef TAIL_FIRST
        tail = seen + 1;
#endif
        c0 = word0[seen % CAPACITY];
        c1 = word1[seen % CAPACITY];
        assert(c0 == item[seen] && c1 == item[seen]);
        seen++
     :: else -> break
     od;
#ifndef TAIL_FIRST
     tail = seen;
#endif
     sleeping = true;
     h = head;
     if
#ifdef NO_SECOND_LOOK
     :: true ->
#else
     :: h == seen ->
#endif
        atomic { /* futex wait: the kernel compares and sleeps in one */
          if
          :: head == h -> asleep = true
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
  head > 0;
  if /* the newest item, or the one before it */
  :: i = head - 1
  :: head > 1 -> i = head - 2
  fi;
  c0 = word0[i % CAPACITY];
  c1 = word1[i % CAPACITY];
  h = head;
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

/* Nobody moves any more: then the solver has taken all that there is. */
active proctype Rest() {
  timeout;
  assert(tail == head)
}

init {
  atomic { run Producer(); run Solver(); run Observer() }
}
