/* Model of ipc/law/commander_record.hpp: a commander that writes its latest request as one record under a sequence
 * counter, may die at any store and is taken over; and a reader that copies the record. Steps interleave one load or
 * store at a time, in program order: this checks the algorithm, not its memory orderings.
 *
 * One reader that reads once represents any number: readers store nothing and remember nothing.
 *
 * Checked: a copy that counts as whole is one request, and one that was completed, or whose last store was next.
 *
 * Each of these flags makes a mutant that must fail: BEFORE_ONLY, AFTER_ONLY, TAKE_ODD, ODD_OF_DEAD, NO_SECOND_LOAD. */

#ifndef LAST
#define LAST 4 /* total number of requests */
#endif
#ifndef LIVES
#define LIVES 3 /* commanders, one after the other */
#endif

byte sequence;
byte word0, word1;

/* One store; the commander may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

proctype Commander() {
  byte life, request, odd;

next_life:
  life++;
  do
  :: request < LAST ->
     request++;
#ifdef ODD_OF_DEAD
     odd = sequence + 1;
#else
     odd = sequence | 1;
#endif
#ifdef BEFORE_ONLY
     STORE(sequence, odd + 1);
#else
#ifndef AFTER_ONLY
     STORE(sequence, odd);
#endif
#endif
     STORE(word0, request);
     STORE(word1, request);
#ifndef BEFORE_ONLY
     STORE(sequence, odd + 1);
#endif
  :: else -> break
  od;
  goto done;
died:
  if
  :: life < LIVES -> goto next_life
  :: else
  fi;
done:
  skip
}

proctype Reader() {
  byte first, second, a, b;

  first = sequence;
  a = word0;
  b = word1;
  second = sequence;
#ifdef NO_SECOND_LOAD
  second = first;
#endif
#ifdef TAKE_ODD
  if
  :: first == second -> assert(a == b)
#else
  if
  :: first == second && first % 2 == 0 -> assert(a == b)
#endif
  :: else
  fi
}

init {
  atomic {
    run Commander();
    run Reader();
  }
}
