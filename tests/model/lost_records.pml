/* Model of the refusals and excesses on the board (ipc/board/refusals.cpp, and the orderings in
 * ipc/board/writer.hpp): a writer that takes items and records some of them, may die before any of its stores
 * and is taken over; and a reader that takes a summary and copies the records that it counts. Steps interleave
 * one load or store at a time, in program order: this checks the algorithm, not its memory orderings.
 *
 * Items are numbered from 1. A revision takes up to two items, with or without a record of each: its successor
 * may take the items of a lost revision without one. With REFUSALS a record is one word, else an excess: one
 * word represents the three after the first one. With STOPS, a revision may begin with an excess of the last
 * item that was taken before it. The summary is stored as a whole: publication.pml has its algorithm. A
 * revision that is discarded acts like one whose writer died just before the commit.
 *
 * One reader that reads once represents any number: readers store nothing and remember nothing.
 *
 * Checked: a record that a reader accepts is the committed one of its number; without a death it accepts all.
 *
 * Each of these flags makes a mutant that must fail:
 * NO_CLEAR         the successor leaves the records of a lost revision
 * CLEAR_LATE       clears them after its first commit
 * CLEAR_WITH_ZERO  clears refusals with 0, which is a refusal of an earlier item
 * CLEAR_FIRST_ONLY clears only the first of them
 * STOP_AT_CLEARED  takes a cleared excess for the end of the lost ones: fails if a successor dies as well
 * NO_ZERO          the writer of an excess does not store 0 before the other words
 * NO_RECHECK       the reader does not load the first word again
 * ITEM_ALONE       accepts the excess of the last item in each place, with STOPS */

#ifndef LAST
#define LAST 4 /* items */
#endif
#ifndef LIVES
#define LIVES 3 /* writers, one after the other */
#endif
#ifdef STOPS
#define KEPT 4
#else
#define KEPT 2
#endif
#define MOST (2 * LAST) /* records */

#ifdef CLEAR_WITH_ZERO
#define CLEARED 0
#elif defined REFUSALS
#define CLEARED 255
#else
#define CLEARED 0
#endif

byte consumed, count; /* the summary */
byte head[KEPT];      /* the item of a record */
byte word[KEPT];      /* its other contents; of a refusal, part of the same word */
byte stopped;         /* the last item whose stop has been recorded */
byte lives;
bool over;

/* For assertions only: the committed records. */
byte held_item[MOST];
byte held_value[MOST];

/* One store; the writer may die before it. */
#define STORE(place, value) if :: place = value :: goto died fi

#define VALUE(item) (16 * life + item)

#ifdef ITEM_ALONE
#define IS_LATER(item, i, n, c) ((item) > c)
#else
#define IS_LATER(item, i, n, c) ((item) + (n - (i) > KEPT / 2 -> 1 : 0) > c)
#endif

#if defined REFUSALS
#define IS_COMMITTED(i) (head[i % KEPT] <= consumed)
#elif defined STOP_AT_CLEARED
#define IS_COMMITTED(i) (!IS_LATER(head[i % KEPT], i, count, consumed))
#else
#define IS_COMMITTED(i) (head[i % KEPT] != 0 && !IS_LATER(head[i % KEPT], i, count, consumed))
#endif

#define CLEAR /* L1 */ \
  i = (count > KEPT -> count - KEPT : 0); \
  do \
  :: i < count && !IS_COMMITTED(i) -> \
     if \
     :: head[i % KEPT] != CLEARED -> STORE(head[i % KEPT], CLEARED) \
     :: else \
     fi; \
     NEXT_TO_CLEAR \
  :: else -> break \
  od; \
  i = 0
#ifdef CLEAR_FIRST_ONLY
#define NEXT_TO_CLEAR i = count
#else
#define NEXT_TO_CLEAR i++
#endif

/* Writes record count + k. */
#if defined REFUSALS
#define WRITE(item) \
  if \
  :: d_step { head[(count + k) % KEPT] = item; word[(count + k) % KEPT] = VALUE(item) } \
  :: goto died \
  fi
#elif defined NO_ZERO
#define WRITE(item) \
  STORE(word[(count + k) % KEPT], VALUE(item)); \
  STORE(head[(count + k) % KEPT], item)
#else
#define WRITE(item) \
  STORE(head[(count + k) % KEPT], 0); \
  STORE(word[(count + k) % KEPT], VALUE(item)); \
  STORE(head[(count + k) % KEPT], item)
#endif

/* Keeps the item of record count + k for the commit. */
#define NOTE(number) d_step { noted[k] = number; k++ }
#define FORGET taken = 0; k = 0; i = 0; stops = false; noted[0] = 0; noted[1] = 0; noted[2] = 0

proctype Writer() {
  byte life, taken, k, i;
  byte noted[3];
  bool stops;

next_life:
  atomic { life++; lives = life };
#if !defined NO_CLEAR && !defined CLEAR_LATE
  CLEAR;
#endif
  do
  :: consumed < LAST ->
#ifdef STOPS
     if
     :: consumed > 0 && stopped != consumed -> stops = true; WRITE(consumed); NOTE(consumed)
     :: true
     fi;
#endif
     do
     :: taken < 2 && consumed + taken < LAST ->
        taken++;
        if
        :: WRITE(consumed + taken); NOTE(consumed + taken)
        :: true
        fi
     :: taken > 0 || stops -> break
     od;
     if /* W3 */
     :: d_step {
          i = 0;
          do
          :: i < k ->
             held_item[count + i] = noted[i];
             held_value[count + i] = VALUE(noted[i]);
             i++
          :: else -> break
          od;
          stopped = (stops -> consumed : stopped);
          consumed = consumed + taken;
          count = count + k;
          FORGET;
        }
     :: goto died
     fi;
#ifdef CLEAR_LATE
     CLEAR
#endif
  :: else -> break
  od;
  goto ended;
died:
  atomic { FORGET };
  if
  :: life < LIVES -> goto next_life
  :: else
  fi;
ended:
  over = true
}

proctype Reader() {
  byte c, n, back, item, value, again, next;
  bool undisturbed;

  d_step { c = consumed; n = count; undisturbed = over && lives == 1 && consumed == LAST }; /* R1 */
  next = c + 1;
  do
  :: back < KEPT && back < n ->
     back++;
#ifdef REFUSALS
     d_step { item = head[(n - back) % KEPT]; value = word[(n - back) % KEPT] };
     if
     :: item >= next -> assert(!undisturbed); break
     :: else
     fi;
     next = item;
#else
     item = head[(n - back) % KEPT];
     value = word[(n - back) % KEPT];
     again = head[(n - back) % KEPT];
#ifdef NO_RECHECK
     again = item;
#endif
     if
     :: item == 0 || again != item || IS_LATER(item, n - back, n, c) ->
        assert(!undisturbed);
        goto next_record
     :: else
     fi;
#endif
     assert(item == held_item[n - back] && value == held_value[n - back]);
next_record:
     atomic { item = 0; value = 0; again = 0 }
  :: else -> break
  od
}

init {
  atomic { run Writer(); run Reader() }
}
