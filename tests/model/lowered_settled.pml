/* Model of the settled word that goes back while a time law holds a stream (ipc/solve/stream_solver.hpp): host
 * time that passes between any two steps, a law that may be released at any time, a solver that cuts the curve
 * where the law holds it and appends to it later, and that may die before any of its stores and is taken over,
 * and a reader.
 *
 * The law rests at stream time 0 until host time `released`, and then moves by 1 in each unit of host time. No
 * revision of the law changes it before its own settled time. A process reads the law at one instant: the order
 * of the loads within it is that of publication.pml. Knot t is the curve at stream time t, and the settled word
 * promises that no later revision changes a knot t < settled, for t that the law has reached for good.
 *
 * Checked: no revision changes a knot that a reader has called settled.
 *
 * Each of these flags makes a mutant that must fail:
 * LOWER_LAST        stores the lower word after the commit
 * NO_SECOND_LOOK    does not read the law again after that store
 * SETTLED_FIRST     the reader loads the settled word before it reads the law */

#define NEVER 255
#define HORIZON 6  /* host time at which the model ends */
#define KNOTS 4    /* stream times */
#define LAW_AHEAD 3
#define AHEAD 1    /* of the stream */
#define HELD 0
#define REST 1     /* where a curve that begins at rest begins: after the held time */

byte now = 0;
byte law_settled = LAW_AHEAD;
byte released = NEVER;
byte settled = KNOTS;
bool claimed[KNOTS]; /* for assertions only: a reader has called the knot settled */

#define POSITION(host) ((host) < released -> 0 : (host) - released)
#define MAX(a, b) ((a) > (b) -> (a) : (b))
/* The law holds at its present position until it may change. */
#define IS_HELD (now < law_settled && POSITION(now) == HELD && POSITION(law_settled - 1) == HELD)
/* The latest stream time that the law has for good. */
#define FINAL MAX(POSITION(now), POSITION(law_settled - 1))

/* One store; the solver may die before it. */
#define STORE(word, value) if :: word = value :: goto died fi

inline change_from(first) {
  byte t = first;
  do
  :: t < KNOTS -> assert(!claimed[t]); t++
  :: else -> break
  od
}

active proctype host() {
  do
  :: now < HORIZON -> now++
  :: else -> break
  od
}

active proctype law() {
  do
  :: atomic { now + LAW_AHEAD > law_settled -> law_settled = now + LAW_AHEAD }
  :: atomic { released == NEVER -> released = MAX(law_settled, now + LAW_AHEAD); law_settled = released }
  :: now == HORIZON -> break
  od
}

active proctype solver() {
  byte lives = 2;
  byte frozen;
  byte before;
  byte first;
  bool is_cut = false;
  bool is_held;
begin:
  do
  :: !is_cut ->
    atomic { is_held = IS_HELD; before = settled }
    if
    :: is_held ->
#ifndef LOWER_LAST
      STORE(settled, REST);
#endif
#ifndef NO_SECOND_LOOK
      is_held = IS_HELD;
#endif
      if
      :: is_held ->
        atomic { /* the clock, then the commit */
          if
          :: POSITION(now) < REST -> first = REST; is_cut = true; change_from(first)
          :: else
          fi
        }
#ifdef LOWER_LAST
        STORE(settled, REST)
#endif
      :: else -> STORE(settled, before)
      fi
    :: else
    fi
  :: is_cut -> /* waypoints after the cut */
    atomic { frozen = MAX(settled, POSITION(now) + AHEAD) }
    if
    :: frozen >= KNOTS -> break
    :: else
    fi;
    atomic {
      if
      :: frozen > POSITION(now) -> change_from(frozen)
      :: else
      fi
    }
    STORE(settled, frozen)
  :: now == HORIZON -> break
  od;
  goto end;
died:
  if
  :: lives > 1 -> lives--;
    goto begin
  :: else
  fi;
end:
}

active proctype reader() {
  byte final;
  byte until;
  byte t;
  do
  :: now < HORIZON ->
#ifdef SETTLED_FIRST
    until = settled;
    atomic { final = FINAL }
#else
    atomic { final = FINAL }
    until = settled;
#endif
    atomic { /* reads the curve */
      t = 0;
      do
      :: t < KNOTS && t < until && t <= final -> claimed[t] = true; t++
      :: else -> break
      od
    }
  :: else -> break
  od
}
