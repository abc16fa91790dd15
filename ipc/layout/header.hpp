#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "ipc/layout/table.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

/// Where every word of the two regions lies: the tables below. layout.md of this folder is the same
/// in words, and is made from them. Whoever adds, moves or changes a row adds 1 to kLayoutVersion.
namespace splinecast::ipc {

inline constexpr std::uint64_t kMagic = 0x54534143'4e4c5053;  // "SPLNCAST" in memory order
inline constexpr std::uint32_t kLayoutVersion = 5;
inline constexpr std::uint32_t kByteOrder = 0x01020304;

/// What different processes write, or poll, lies this far apart: two cache lines, because adjacent
/// lines are fetched in pairs.
inline constexpr std::size_t kSeparation = 128;
inline constexpr std::size_t kCacheLine = 64;
inline constexpr std::size_t kPage = 4096;

inline constexpr std::size_t kNameBytes = 32;
inline constexpr std::size_t kUnitBytes = 16;

/// The two numbers of the header's second word, which no layout moves: every version finds out by
/// them that another one has made a region.
struct LayoutMark {
  std::uint32_t version = kLayoutVersion;
  std::uint32_t byte_order = kByteOrder;
};

/// The first words of both regions, as kHeaderRows places them.
struct RegionHeader {
  std::uint64_t magic;
  LayoutMark mark;
  std::uint64_t layout_hash;
  std::uint64_t kind;            ///< RegionKind
  std::uint64_t region_bytes;    ///< size of the whole region
  std::uint64_t stream_id;       ///< random; the same in both regions of a stream
  std::uint64_t dimensions;      ///< 1 … 64
  std::uint64_t capacity;        ///< ring items or knot slots, a power of two
  std::uint64_t clock;           ///< StreamClock
  std::uint64_t time_namespace;  ///< inode of the time namespace of a live stream's clock
  std::uint64_t control;         ///< offset of the control block, in bytes
  std::uint64_t stride;          ///< bytes from one ring item or knot slot to the next
  std::int64_t min_interval;     ///< ns between waypoints
  std::int64_t max_interval;
  std::uint64_t start_kind;  ///< ConditionKind at the first waypoint
  std::uint64_t method;      ///< Method::number; 0: c2
  std::uint64_t settle;      ///< settle lag K
  std::uint64_t tail;        ///< Tail
  std::int64_t stop_time;    ///< ns
  std::uint64_t epoch;       ///< number of the owner's life, from 1
  std::uint64_t owner_pid;
  std::int64_t owner_since;   ///< CLOCK_MONOTONIC when the owner took the region
  double lambda;              ///< of smoothing, s³
  double time_scale;          ///< of rounded, s
  std::uint64_t force_lag;    ///< 1: a lag too short for lambda is taken
  std::int64_t freeze_ahead;  ///< ns that a live stream settles ahead of now
  std::int64_t history;       ///< ns before now that a live stream keeps
  std::int64_t min_splice;    ///< ns: length of the shortest splice
  std::array<double, kMaxDimensions> start_value;
  std::array<std::uint64_t, kMaxDimensions> dimension_kind;  ///< DimensionKind
  std::array<double, kMaxDimensions> period;                 ///< of `wrap`; else 0
  std::array<std::array<char, kNameBytes>, kMaxDimensions> name;
  std::array<std::array<char, kUnitBytes>, kMaxDimensions> unit;
  std::array<double, kMaxDimensions> max_velocity;  ///< 0: no limit, as in the next two
  std::array<double, kMaxDimensions> max_acceleration;
  std::array<double, kMaxDimensions> max_jerk;
  std::array<double, kMaxDimensions> lower_bound;  ///< both bounds 0: none
  std::array<double, kMaxDimensions> upper_bound;
  std::uint64_t beyond;  ///< Beyond
};

inline constexpr std::tuple kHeaderRows{
    MemberRow<&RegionHeader::magic>{"magic", FieldWriter::maker, "the characters `SPLNCAST`"},
    MemberRow<&RegionHeader::mark>{"layout version, byte order", FieldWriter::maker,
                                   "32 bits each: 5 and `0x01020304`"},
    MemberRow<&RegionHeader::layout_hash>{"layout hash", FieldWriter::maker,
                                          "FNV-1a over the fields of this page"},
    MemberRow<&RegionHeader::kind>{"kind", FieldWriter::maker, "1 waypoints, 2 spline"},
    MemberRow<&RegionHeader::region_bytes>{"region bytes", FieldWriter::maker, "size of the file"},
    MemberRow<&RegionHeader::stream_id>{"stream id", FieldWriter::maker,
                                        "random, not 0; the same in both regions"},
    MemberRow<&RegionHeader::dimensions>{"dimensions", FieldWriter::maker, "D, 1 to 64"},
    MemberRow<&RegionHeader::capacity>{"capacity", FieldWriter::maker,
                                       "ring items or knot slots; a power of two"},
    MemberRow<&RegionHeader::clock>{"clock", FieldWriter::maker, "0 recorded, 1 CLOCK_MONOTONIC"},
    MemberRow<&RegionHeader::time_namespace>{"time namespace", FieldWriter::maker,
                                             "inode of `/proc/self/ns/time` on a live stream"},
    MemberRow<&RegionHeader::control>{"control offset", FieldWriter::maker,
                                      "where the control block begins, in bytes"},
    MemberRow<&RegionHeader::stride>{"stride", FieldWriter::maker,
                                     "bytes from one item or slot to the next"},
    MemberRow<&RegionHeader::min_interval>{"least interval", FieldWriter::maker,
                                           "between waypoints, ns"},
    MemberRow<&RegionHeader::max_interval>{"most interval", FieldWriter::maker, "ns"},
    MemberRow<&RegionHeader::start_kind>{
        "start condition", FieldWriter::maker,
        "0 natural, 1 rest, 2 halt, 3 velocity, 4 acceleration, 7 the method's own"},
    MemberRow<&RegionHeader::method>{
        "method", FieldWriter::maker,
        "0 c2, 1 hermite, 2 quintic, 4 smoothing, 16 bessel, 17 akima, 18 makima, 19 pchip, 20 "
        "rounded (spline region, as all up to the stop time)"},
    MemberRow<&RegionHeader::settle>{"settle lag", FieldWriter::maker, "K"},
    MemberRow<&RegionHeader::tail>{"tail", FieldWriter::maker,
                                   "0 bessel, 1 parabolic, 2 natural, 3 rest"},
    MemberRow<&RegionHeader::stop_time>{"stop time", FieldWriter::maker, "ns"},
    MemberRow<&RegionHeader::epoch>{"epoch", FieldWriter::owner,
                                    "number of the owner's life, from 1"},
    MemberRow<&RegionHeader::owner_pid>{"process id", FieldWriter::owner, "of the owner"},
    MemberRow<&RegionHeader::owner_since>{"since", FieldWriter::owner,
                                          "CLOCK_MONOTONIC at which it became the owner"},
    MemberRow<&RegionHeader::lambda>{"lambda", FieldWriter::maker,
                                     "double, s³: of `smoothing` (spline region, as all below)"},
    MemberRow<&RegionHeader::time_scale>{"time scale", FieldWriter::maker,
                                         "double, s: of `rounded`"},
    MemberRow<&RegionHeader::force_lag>{"lag forced", FieldWriter::maker,
                                        "1: a settle lag too short for λ is taken"},
    MemberRow<&RegionHeader::freeze_ahead>{"freeze-ahead", FieldWriter::maker,
                                           "ns, of a live stream"},
    MemberRow<&RegionHeader::history>{"history", FieldWriter::maker, "ns, of a live stream"},
    MemberRow<&RegionHeader::min_splice>{"shortest splice", FieldWriter::maker,
                                         "ns, of a live stream"},
    padding(4),
    MemberRow<&RegionHeader::start_value>{"start value", FieldWriter::maker,
                                          "a double per dimension: of the start condition"},
    MemberRow<&RegionHeader::dimension_kind>{
        "dimension kind", FieldWriter::maker,
        "a word per dimension: 0 linear, 1 wrap, 2 quaternion as x y z w, 3 quaternion as w x y z; "
        "all four dimensions of a quaternion have the same"},
    MemberRow<&RegionHeader::period>{
        "period", FieldWriter::maker,
        "a double per dimension: of one that wraps, in its unit, 1e-100 to 1e100; else 0"},
    MemberRow<&RegionHeader::name>{"name", FieldWriter::maker,
                                   "32 bytes per dimension, zero-terminated"},
    MemberRow<&RegionHeader::unit>{"unit", FieldWriter::maker,
                                   "16 bytes per dimension, zero-terminated"},
    MemberRow<&RegionHeader::max_velocity>{
        "velocity limit", FieldWriter::maker,
        "a double per dimension, 0 for none (spline region, as all below)"},
    MemberRow<&RegionHeader::max_acceleration>{"acceleration limit", FieldWriter::maker,
                                               "a double per dimension, 0 for none"},
    MemberRow<&RegionHeader::max_jerk>{"jerk limit", FieldWriter::maker,
                                       "a double per dimension, 0 for none"},
    MemberRow<&RegionHeader::lower_bound>{"lower bound", FieldWriter::maker,
                                          "a double per dimension: of the position, −∞ for none; 0 "
                                          "with an upper bound of 0 says that "
                                          "there are no bounds"},
    MemberRow<&RegionHeader::upper_bound>{"upper bound", FieldWriter::maker,
                                          "a double per dimension, +∞ for none"},
    MemberRow<&RegionHeader::beyond>{
        "beyond the limits", FieldWriter::maker,
        "what is done about such a segment: 0 report it, 1 refuse its waypoint"}};
inline constexpr auto kHeaderFields = place(kHeaderRows);
inline constexpr std::size_t kHeaderWords = size_of(kHeaderFields).words;

/// Where the parts of a region lie that all regions have.
inline constexpr std::tuple kRegionRows{
    FieldRow{"header",
             {.words = 2 * kPage / sizeof(Word)},
             FieldWriter::maker,
             "see below; the rest is 0"},
    FieldRow{"control area",
             {.words = 2 * kPage / sizeof(Word)},
             FieldWriter::owner,
             "the control block lies in it, at 8192 + 128 · (stream id mod 49), so that those of "
             "many streams do not fall into one cache set"},
    FieldRow{"body",
             {},
             FieldWriter::owner,
             "ring items; or the refusals, times and slots of a "
             "board"}};
inline constexpr auto kRegionFields = place(kRegionRows);
inline constexpr std::size_t kHeaderBytes = word_of(kRegionFields, "control area") * sizeof(Word);
inline constexpr std::size_t kBodyOffset = word_of(kRegionFields, "body") * sizeof(Word);
static_assert(kHeaderWords * sizeof(Word) <= kHeaderBytes);

/// The control block of a waypoints region.
inline constexpr std::size_t kLineWords = kSeparation / sizeof(Word);
inline constexpr std::size_t kProducerRefusals = 16;
inline constexpr std::tuple kRingControlRows{
    FieldRow{"head", {.words = 1}, FieldWriter::owner, "items appended"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0 once the region is of no use"},
    FieldRow{"claimed",
             {.words = 1},
             FieldWriter::owner,
             "how far the last replacement writes, stored before its items"},
    padding(kLineWords - 3),
    FieldRow{"refused",
             {.words = kProducerRefusals},
             FieldWriter::owner,
             "items refused by the producer, a word per reason"}};
inline constexpr auto kRingControlFields = place(kRingControlRows);
inline constexpr std::size_t kRingControlWords = size_of(kRingControlFields).words;
inline constexpr std::size_t kHead = word_of(kRingControlFields, "head");
inline constexpr std::size_t kClaimed = word_of(kRingControlFields, "claimed");
inline constexpr std::size_t kProducerCounters = word_of(kRingControlFields, "refused");

/// Ring items: kind and flags, time, then position, velocity and acceleration of D words each.
inline constexpr std::tuple kItemRows{
    FieldRow{"kind",
             {.words = 1},
             FieldWriter::owner,
             "kind (bits 0–7: 1 waypoint, 2 replace, 3 start state, 4 finish), velocity given (bit "
             "8), acceleration given (bit 9), end condition of a finish (bits 16–23), waypoints "
             "that follow a replace and belong to it (bits 32–63)"},
    FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns"},
    FieldRow{"position",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles; of a replace with waypoints, in the first word: ns that the entry takes at "
             "least"},
    FieldRow{"velocity", {.per_dimension = 1}, FieldWriter::owner, "doubles, where given"},
    FieldRow{"acceleration", {.per_dimension = 1}, FieldWriter::owner, "doubles, where given"}};
inline constexpr auto kItemFields = place(kItemRows);
inline constexpr std::size_t kItemKind = word_of(kItemFields, "kind");
inline constexpr std::size_t kItemTime = word_of(kItemFields, "time");
inline constexpr std::size_t kItemValues = word_of(kItemFields, "position");

inline constexpr std::size_t kRefusalReasons = 16;

/// Where the end of the published curve stands to the *target*, the spline through the waypoints of
/// a run.
enum class Course : std::uint8_t {
  on_target = 0,  ///< it is the target
  waiting = 1,    ///< it ends in a stop beside the target: no entry has been found
  entering = 2,   ///< an entry ends at a waypoint of the run, and the target follows
  beyond = 3,     ///< an entry ends beyond the newest waypoint, and a stop follows
};
inline constexpr int kCourses = 4;

/// What holds for a whole revision.
struct Head {
  Word revision = 0;  ///< the revision that this head is of; 0: none yet
  Word first = 0;     ///< oldest knot on the board; a segment begins there
  Word newest = 0;    ///< newest knot; 0: none. Of a stream that goes on its stop begins there
  Time stop{};        ///< length of the stop, if that is the newest segment
  bool finished = false;
  Word run = 1;        ///< first knot of the run
  Word run_knots = 0;  ///< waypoints of the run
  Word run_item = 0;   ///< the ring's item of its first waypoint, plus 1; 0: none yet
  Word course = 0;     ///< Course
  Word met = 0;    ///< waypoints of the run before the piece of the target that ends at `newest`
  Word unmet = 0;  ///< waypoints of the run before those that the open entry passes over
  Time blend_until{};         ///< no entry of the run ends before
  Word passed_over = 0;       ///< waypoints that entries pass over, of all runs
  Word consumed = 0;          ///< ring items taken
  Word knots = 0;             ///< waypoints taken, replaced ones too
  Time newest_knot{};         ///< time of the newest waypoint, or of the state that a run begins in
  Time committed{};           ///< the solver's clock at the commit; of a recorded stream, roughly
  Word run_frozen = 0;        ///< waypoints of the run that were frozen when this revision was made
  bool is_later_run = false;  ///< the run is not the stream's first, or begins in a given state
  bool starved = false;       ///< a live stream's settled time has passed its newest knot
  Time low_water = Time::max();  ///< least depth so far; max() before there was any
  Word underruns = 0;            ///< times that a live stream has starved
  Word misses = 0;               ///< revisions discarded because they came too late
  Word revisions = 0;            ///< revisions committed too late, this one too: readers are told
  Word withdrawn = 0;            ///< items that a replacement withdrew unread
  Word controls = 0;             ///< replacements, start states and finishes carried out
  Word exceeding = 0;  ///< waypoints that brought the curve, or would have, beyond a limit
  Word refused = 0;    ///< items refused
  std::array<Word, kRefusalReasons> reasons{};  ///< of these, by Refusal
  Time settled_until{};  ///< no time before it ever changes; not of the revision alone
  Time changed_from{};   ///< earliest time whose curve this revision changed

  /// Waypoints that the curve interpolates, replaced ones too.
  [[nodiscard]] Word interpolated() const noexcept { return knots - passed_over; }
};

/// A cell of the head's slot. What lookups need comes first, in one cache line; what changes rarely
/// last: a revision stores what is not in the cell already.
inline constexpr std::tuple kHeadRows{
    FieldRow{"tag", {.words = 1}, FieldWriter::owner, "revision · 65,536"},
    MemberRow<&Head::first>{"first", FieldWriter::owner,
                            "oldest knot on the board; a segment begins there"},
    MemberRow<&Head::newest>{"newest", FieldWriter::owner, "newest knot; 0: none"},
    MemberRow<&Head::stop>{"stop", FieldWriter::owner,
                           "ns: length of the stop, while it is the newest segment"},
    MemberRow<&Head::finished>{"finished", FieldWriter::owner, "1: nothing follows"},
    MemberRow<&Head::run>{"run", FieldWriter::owner, "first knot of the run"},
    MemberRow<&Head::run_knots>{"knots of the run", FieldWriter::owner, "its waypoints"},
    MemberRow<&Head::run_item>{"item of the run", FieldWriter::owner,
                               "number of its first waypoint's item, plus 1; 0: none yet"},
    MemberRow<&Head::course>{"course", FieldWriter::owner,
                             "0 on the target, 1 waiting, 2 entering at a waypoint, 3 beyond the "
                             "newest one"},
    MemberRow<&Head::met>{"met", FieldWriter::owner,
                          "waypoints of the run before the piece of the target that ends at the "
                          "newest knot"},
    MemberRow<&Head::unmet>{"unmet", FieldWriter::owner,
                            "waypoints of the run before those that the open entry passes over"},
    MemberRow<&Head::blend_until>{"blend until", FieldWriter::owner,
                                  "ns: no entry of the run ends before"},
    MemberRow<&Head::passed_over>{"passed over", FieldWriter::owner,
                                  "waypoints that entries pass over"},
    MemberRow<&Head::consumed>{"consumed", FieldWriter::owner, "items taken"},
    MemberRow<&Head::knots>{"knots", FieldWriter::owner, "waypoints taken"},
    MemberRow<&Head::newest_knot>{"newest time", FieldWriter::owner,
                                  "time of the newest waypoint, or of the state that a run begins "
                                  "in, ns"},
    MemberRow<&Head::committed>{"committed", FieldWriter::owner,
                                "the solver's clock at the commit, ns; of a recorded stream to "
                                "within some milliseconds"},
    MemberRow<&Head::run_frozen>{"frozen", FieldWriter::owner,
                                 "waypoints of the run that were frozen when this revision was "
                                 "made"},
    MemberRow<&Head::is_later_run>{"later run", FieldWriter::owner,
                                   "1: the run is not the stream's first, or begins in a given "
                                   "state"},
    MemberRow<&Head::starved>{"starved", FieldWriter::owner,
                              "1: the settled time of a live stream has passed its newest knot"},
    MemberRow<&Head::low_water>{"least depth", FieldWriter::owner, "so far, ns"},
    MemberRow<&Head::underruns>{"underruns", FieldWriter::owner, "times starved"},
    MemberRow<&Head::misses>{"misses", FieldWriter::owner, "revisions discarded as too late"},
    MemberRow<&Head::revisions>{"late revisions", FieldWriter::owner,
                                "revisions before this one that were committed too late"},
    MemberRow<&Head::withdrawn>{"withdrawn", FieldWriter::owner, "items withdrawn unread"},
    MemberRow<&Head::controls>{"controls", FieldWriter::owner,
                               "replacements, start states and finishes carried out"},
    MemberRow<&Head::exceeding>{"exceeding", FieldWriter::owner,
                                "waypoints that brought the curve, or would have, beyond a limit"},
    MemberRow<&Head::refused>{"refused", FieldWriter::owner, "items refused"},
    MemberRow<&Head::reasons>{"reasons", FieldWriter::owner, "items refused, by reason"},
    padding(4)};
inline constexpr auto kHeadFields = place(kHeadRows);
inline constexpr std::size_t kHeadWords = size_of(kHeadFields).words;
static_assert(kHeadWords % (kCacheLine / sizeof(Word)) == 0);

inline constexpr std::size_t kChangesKept = 64;
inline constexpr std::size_t kStepBuckets = 40;

/// The control block of a spline region.
inline constexpr std::tuple kBoardControlRows{
    FieldRow{
        "revision", {.words = 1}, FieldWriter::owner, "the commit word, and what readers wait on"},
    FieldRow{"retired", {.words = 1}, FieldWriter::owner, "not 0 once the region is of no use"},
    FieldRow{"settled until",
             {.words = 1},
             FieldWriter::owner,
             "ns: no revision after the one that stood when it was stored changes anything before"},
    padding(kLineWords - 3),
    FieldRow{"tail", {.words = 1}, FieldWriter::owner, "items consumed, a copy for the producer"},
    FieldRow{"late",
             {.words = 1},
             FieldWriter::owner,
             "the last revision that was committed too late, on a live stream"},
    FieldRow{"checked",
             {.words = 1},
             FieldWriter::owner,
             "the last revision whose commit was compared with the clock, on a live stream"},
    padding(kLineWords - 3),
    FieldRow{"sleeping", {.words = 1}, FieldWriter::owner, "the solver waits on `head`"},
    padding(kLineWords - 1),
    FieldRow{"head, cell 0", {.words = kHeadWords}, FieldWriter::owner, "see below"},
    FieldRow{"head, cell 1", {.words = kHeadWords}, FieldWriter::owner, "see below"},
    FieldRow{"changed from",
             {.words = kChangesKept},
             FieldWriter::owner,
             "ns: earliest time whose curve revision r changed, at r mod 64"},
    FieldRow{"step times",
             {.words = kStepBuckets},
             FieldWriter::owner,
             "how many of the solver's steps took 2ⁱ to 2ⁱ⁺¹ ns, at i; the last one counts all "
             "that took longer"}};
inline constexpr auto kBoardControlFields = place(kBoardControlRows);
inline constexpr std::size_t kBoardControlWords = size_of(kBoardControlFields).words;
inline constexpr std::size_t kRevision = word_of(kBoardControlFields, "revision");
inline constexpr std::size_t kRetired = word_of(kBoardControlFields, "retired");
inline constexpr std::size_t kSettledUntil = word_of(kBoardControlFields, "settled until");
inline constexpr std::size_t kTail = word_of(kBoardControlFields, "tail");
inline constexpr std::size_t kLate = word_of(kBoardControlFields, "late");
inline constexpr std::size_t kChecked = word_of(kBoardControlFields, "checked");
inline constexpr std::size_t kSleeping = word_of(kBoardControlFields, "sleeping");
inline constexpr std::size_t kHeadSlot = word_of(kBoardControlFields, "head, cell 0");
inline constexpr std::size_t kChanges = word_of(kBoardControlFields, "changed from");
inline constexpr std::size_t kStepTimes = word_of(kBoardControlFields, "step times");
static_assert(word_of(kRingControlFields, "retired") == kRetired);
static_assert(kRevision == 0 && kHead == 0);  // what waiting processes watch

/// How many positions the control block may have within the control area.
inline constexpr std::size_t kControlPositions =
    (kBodyOffset - kHeaderBytes - kBoardControlWords * sizeof(Word)) / kSeparation + 1;
static_assert(kRingControlWords <= kBoardControlWords);

/// The parts of a knot's slot. Each lies there twice, beginning on a cache line.
inline constexpr std::tuple kCellRows{
    FieldRow{"tag",
             {.words = 1},
             FieldWriter::owner,
             "0 never written; else revision (bits 16–63; all ones: retired), the node that it "
             "refers to (bit 0), the form of the segment that begins here (bits 1–4: 0 none, 1 "
             "cubic, 2 cubic with acceleration 0 at the left end, 3 at the right end, 4 at both, 5 "
             "quintic, 6 splice, 7 stop, 8 hold), a waypoint stands here (bit 5), the acceleration "
             "beside is that with which the segment that ends here arrives (bit 6), or the one "
             "that begins here starts (bit 7), how many newer knots it had seen when it was solved "
             "(bits 8–14), the row that it refers to (bit 15)"},
    FieldRow{"velocity", {.per_dimension = 1}, FieldWriter::owner, "doubles"},
    FieldRow{"residual",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, of `smoothing` only: waypoint less position"}};
inline constexpr auto kCellFields = place(kCellRows);
inline constexpr std::size_t kCellTag = word_of(kCellFields, "tag");
inline constexpr std::size_t kCellVelocity = word_of(kCellFields, "velocity");

inline constexpr std::tuple kNodeRows{FieldRow{"time", {.words = 1}, FieldWriter::owner, "ns"},
                                      FieldRow{"position",
                                               {.per_dimension = 1},
                                               FieldWriter::owner,
                                               "doubles: of the waypoint, else of the curve"}};
inline constexpr auto kNodeFields = place(kNodeRows);
inline constexpr std::size_t kNodeTime = word_of(kNodeFields, "time");
inline constexpr std::size_t kNodePosition = word_of(kNodeFields, "position");

inline constexpr std::tuple kBesideRows{
    FieldRow{"item",
             {.words = 1},
             FieldWriter::owner,
             "of a splice: number of the item of the run's first waypoint, plus 1; of the end of "
             "one beyond the newest waypoint: number of waypoints of the run; of a waypoint that "
             "is passed over: item of the run · 2²⁴ + its number in the run; else 0"},
    FieldRow{"acceleration",
             {.per_dimension = 1},
             FieldWriter::owner,
             "doubles, where the tag says so"}};
inline constexpr auto kBesideFields = place(kBesideRows);
inline constexpr std::size_t kBesideItem = word_of(kBesideFields, "item");
inline constexpr std::size_t kBesideAcceleration = word_of(kBesideFields, "acceleration");

inline constexpr std::tuple kRowRows{
    FieldRow{"gamma", {.words = 1}, FieldWriter::owner, "double: γ of the knot's eliminated row"},
    FieldRow{"g", {.per_dimension = 1}, FieldWriter::owner, "doubles: its right side"},
    FieldRow{"factors",
             {.words = 3},
             FieldWriter::owner,
             "doubles, of `smoothing` only: the row of LDLᵀ: D, L with the knot before, L with the "
             "one before that"}};
inline constexpr auto kRowFields = place(kRowRows);
inline constexpr std::size_t kRowGamma = word_of(kRowFields, "gamma");
inline constexpr std::size_t kRowG = word_of(kRowFields, "g");

/// The ring of refusals.
inline constexpr std::size_t kRefusalsKept = 1024;
inline constexpr std::size_t kExcessesKept = 128;
inline constexpr std::size_t kExcessWords = 4;
inline constexpr unsigned kExcessItemShift = 10;
inline constexpr unsigned kExcessDimensionShift = 4;
inline constexpr std::tuple kBodyRows{
    FieldRow{"refusals",
             {.words = kRefusalsKept},
             FieldWriter::owner,
             "the last 1,024: item number · 256 + reason"},
    FieldRow{"excesses",
             {.words = kExcessesKept * kExcessWords},
             FieldWriter::owner,
             "the last 128 waypoints with which a limit was passed, 4 words each: 0 while it is "
             "written, else item number · 1,024 + dimension · 16 + kind (0 velocity, 1 "
             "acceleration, 2 jerk, 3 position) · 2 + 1 if it was refused; when, in ns; the value, "
             "and the limit, as doubles"},
    FieldRow{"times",
             {},
             FieldWriter::owner,
             "a word per slot: ns at which the segment of the slot's knot begins, or, where none "
             "begins, the one of the next knot at which one does: a hint"}};

/// Slots behind those of the numbered knots: the waypoints that entries pass over, by their number
/// in the run. Only a solver that takes over reads them.
inline constexpr std::size_t kPassedSlots = 80;
inline constexpr unsigned kPassedItemShift = 24;
inline constexpr auto kBodyFields = place(kBodyRows);

/// Offsets of a waypoint ring, derived from what its header fixes; all in bytes.
struct RingLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  std::size_t items;
  std::size_t stride;
  std::size_t bytes;

  [[nodiscard]] static RingLayout of(std::size_t dimensions, std::size_t capacity,
                                     std::size_t control) noexcept;
};

/// Offsets of a knot board, in bytes; those of a slot's parts from its beginning.
struct BoardLayout {
  std::size_t dimensions;
  std::size_t capacity;
  std::size_t control;
  bool smooths;          ///< cells have residuals, rows have factors
  std::size_t refusals;  ///< kRefusalsKept words
  std::size_t excesses;  ///< kExcessesKept of kExcessWords each
  std::size_t times;     ///< packed times: capacity words
  std::size_t slots;     ///< capacity + kPassedSlots slots
  std::size_t cell;      ///< bytes of a cell; cells begin a slot
  std::size_t nodes;
  std::size_t node;  ///< bytes of a node
  std::size_t beside;
  std::size_t beside_bytes;
  std::size_t rows;
  std::size_t row;     ///< bytes of a row
  std::size_t stride;  ///< bytes of a slot
  std::size_t bytes;

  [[nodiscard]] static BoardLayout of(std::size_t dimensions, std::size_t capacity,
                                      std::size_t control, bool smooths) noexcept;
};

/// Largest capacities, so that every size and index computed from a header fits.
inline constexpr std::size_t kMaxRingCapacity = std::size_t{1} << 24;
inline constexpr std::size_t kMaxBoardCapacity = std::size_t{1} << 22;

/// Longest stop tail: so short that a stop, and the way back behind it, can be added to any time.
inline constexpr Time kLongestStop{std::int64_t{1} << 60};

/// Whether a header's method smooths: then its board's cells and rows have more words.
[[nodiscard]] bool smooths(const RegionHeader& header) noexcept;

/// Copies a header out of a region, word by word: what a process checks is what it then uses,
/// whatever happens to the region meanwhile. Its loads are relaxed: the header was written before
/// the region got its name, and the kernel has put the look-up of that name behind it. Throws
/// BadRegion if the region is too short to hold one.
[[nodiscard]] RegionHeader copy_header(std::span<const std::byte> region);

/// Throws BadRegion, naming the offending value, unless the copied header describes a region of
/// this kind, layout, byte order and real size. Returns its layout.
RingLayout checked_ring_layout(const RegionHeader& header, std::size_t real_bytes);
BoardLayout checked_board_layout(const RegionHeader& header, std::size_t real_bytes);

/// The same from words that have been copied already, at least kHeaderWords of them.
[[nodiscard]] RegionHeader decode_header(std::span<const Word> words) noexcept;

/// Writes a header into a region that has no name yet.
void write_header(std::span<std::byte> region, const RegionHeader& header) noexcept;

/// The kinds of a header's dimensions, one each; the header's numbers must be kinds.
[[nodiscard]] std::vector<Dimension> dimensions_of(const RegionHeader& header);

/// A name or unit of a header, up to its first zero byte.
template <std::size_t N>
[[nodiscard]] std::string text_of(const std::array<char, N>& bytes) {
  std::size_t length = 0;
  while (length < N && bytes[length] != 0) ++length;
  return {bytes.data(), length};
}

}  // namespace splinecast::ipc
