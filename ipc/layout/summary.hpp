#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "core/motion/end.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

inline constexpr std::size_t kRefusalReasons = 32;

/// The state of the end of the published curve relative to the *target*, the spline through the
/// waypoints of a run.
enum class Course : std::uint8_t {
  on_target = 0,  ///< the curve follows the target
  waiting = 1,    ///< it ends in a stop away from the target: no entry has been found
  entering = 2,   ///< an entry ends at a waypoint of the run, and the target follows
  ahead = 3,      ///< an entry ends ahead of the newest waypoint, and a stop follows
  starting = 4,   ///< it rests at the first waypoint: the start is not decided yet
};
inline constexpr int kCourses = 5;

using core::EndKind;
inline constexpr std::size_t kEndKinds = 6;

/// Whether a curve that keeps its limits (Beyond::enter) follows its waypoints.
enum class Following : std::uint8_t {
  meets = 0,          ///< it has met one within the last kUnmetTold
  meets_none = 1,     ///< it has met none for longer
  cannot_follow = 2,  ///< it has met none for longer than kUnmetRefused: waypoints are refused
};
[[nodiscard]] constexpr std::string_view to_string(Following following) noexcept {
  switch (following) {
    case Following::meets_none:
      return "meets none";
    case Following::cannot_follow:
      return "cannot follow";
    default:
      return "meets";
  }
}
inline constexpr Time kUnmetReported{1'000'000'000};
inline constexpr Time kUnmetRefused{3'000'000'000};

/// No item has this number.
inline constexpr Word kNoItem = ~Word{0};

/// The summary: the values of a whole revision.
struct Summary {
  Word revision = 0;  ///< the revision of this summary; 0: none yet
  Word first = 0;     ///< oldest knot on the board; a segment begins there
  Word newest = 0;    ///< newest knot; 0: none. Unless the stream is finished, its stop begins
                      ///< there
  Time stop{};        ///< length of the stop, if that is the newest segment
  bool finished = false;
  Word run = 1;        ///< first knot of the run
  Word run_knots = 0;  ///< waypoints of the run
  Word run_item = 0;   ///< number of the ring item of its first waypoint, plus 1; 0: none yet
  Word course = 0;     ///< Course
  /// The waypoints of the run, counted from 0, at which the last piece of the target begins (the
  /// piece that ends at `newest`), and at which those begin that the open entry passes over.
  Word met = 0;
  Word unmet = 0;
  Time blend_until = Time::min();  ///< no entry of the run ends before this time
  Word passed_over = 0;            ///< waypoints that entries pass over, of all runs
  Word consumed = 0;               ///< ring items consumed
  Word knots = 0;                  ///< waypoints accepted, including replaced ones
  Time newest_time{};         ///< time of the newest waypoint, or of the state that a run begins in
  Time committed{};           ///< the solver's clock at the commit; of a recorded stream,
                              ///< approximate
  Word run_frozen = 0;        ///< waypoints of the run that were frozen when this revision was made
  bool is_later_run = false;  ///< the run is not the stream's first, or begins in a given state
  bool starved = false;       ///< a live stream's settled time has passed its newest knot
  Time low_water = Time::max();  ///< least depth so far; max() if there was none yet
  Word underruns = 0;            ///< times that a live stream has starved
  Word deadline_misses = 0;      ///< revisions discarded because they were too late
  Word late_commits = 0;         ///< revisions committed too late, including this one: readers may
                                 ///< get `revised`
  Word withdrawn = 0;            ///< items that a replacement withdrew before they were read
  Word cut_off = 0;              ///< waypoints that the curve was on and a stopper's stop cut off
  Word controls = 0;             ///< replacements, start states and finishes carried out
  Word exceeding = 0;            ///< waypoints with which the curve exceeded a limit, or would have
  Word refused = 0;              ///< items refused
  std::array<Word, kRefusalReasons> reasons{};  ///< items refused, by Refusal
  Word holders = 0;                             ///< stoppers that hold the stream
  Word holder = 0;                              ///< slot of one of them in the table of stoppers
  Word end_kind = 0;                            ///< EndKind
  Word end_item = 0;    ///< item that finished the stream; 0 unless end_kind is set
  Time end_lateness{};  ///< how long after the last waypoint's time the curve rests at it
  /// Longest time in the last second by which a step of a live stream began late, or until it
  /// committed.
  Time longest_pause{};
  /// With Beyond::enter: time of the first waypoint after the last one that the curve meets; max()
  /// if it meets the newest one.
  Time unmet_since = Time::max();
  /// With Beyond::enter: the curve cannot follow its waypoints. It ends as it is planned, and
  /// waypoints up to this time are refused; max(): it follows them.
  Time refused_until = Time::max();
  Word outcomes = 0;         ///< records of outcomes that were written
  Word undecided = kNoItem;  ///< first item of a waypoint that the curve neither meets nor has
                             ///< passed over; kNoItem if there is none
  /// The curve before this time never changes. May be raised without a revision.
  Time settled_until = -kLatestTime;
  Time changed_from{};  ///< earliest time whose curve this revision changed

  /// How the curve ends; `none` if end_kind is out of range.
  [[nodiscard]] EndKind ending() const noexcept {
    return end_kind < kEndKinds ? static_cast<EndKind>(end_kind) : EndKind::none;
  }
  /// Whether the curve follows its waypoints.
  [[nodiscard]] Following following() const noexcept {
    if (refused_until < Time::max()) return Following::cannot_follow;
    if (unmet_since == Time::max() || newest_time <= unmet_since) return Following::meets;
    return newest_time - unmet_since > kUnmetReported ? Following::meets_none : Following::meets;
  }
  /// Waypoints that the curve interpolates, including replaced ones.
  [[nodiscard]] Word interpolated() const noexcept { return knots - passed_over - cut_off; }
  /// Items withdrawn, by a replacement or by a stopper.
  [[nodiscard]] Word all_withdrawn() const noexcept { return withdrawn + cut_off; }
};

/// The values that lookups need, in one cache line: the first rows of the summary's cell.
inline constexpr std::tuple kBoundsRows{
    FieldRow{"tag", {.words = 1}, FieldWriter::owner, "revision · 131,072"},
    MemberRow<&Summary::first>{"first", FieldWriter::owner,
                               "oldest knot on the board; a segment begins there"},
    MemberRow<&Summary::newest>{"newest", FieldWriter::owner, "newest knot; 0: none"},
    MemberRow<&Summary::stop>{"stop", FieldWriter::owner,
                              "ns: length of the stop segment, if it is the newest segment"},
    MemberRow<&Summary::finished>{"finished", FieldWriter::owner, "1: the stream is finished"}};
inline constexpr std::size_t kBoundsWords = size_of(place(kBoundsRows)).words;
static_assert(kBoundsWords <= kCacheLine / sizeof(Word));

/// The other values of a revision. Those that change rarely come last: a revision stores only words
/// that differ from the cell's.
inline constexpr std::tuple kFurtherRows{
    MemberRow<&Summary::run>{"run", FieldWriter::owner, "first knot of the run"},
    MemberRow<&Summary::run_knots>{"knots of the run", FieldWriter::owner,
                                   "number of its waypoints"},
    MemberRow<&Summary::run_item>{"item of the run", FieldWriter::owner,
                                  "number of its first waypoint's item, plus 1; 0: none yet"},
    MemberRow<&Summary::course>{
        "course", FieldWriter::owner,
        "0 on the target, 1 waiting for an entry,\n"
        "2 an entry ends at a waypoint, 3 an entry ends beyond the newest waypoint,\n"
        "4 at rest at the first waypoint: the start is not decided yet"},
    MemberRow<&Summary::met>{"met", FieldWriter::owner,
                             "number of waypoints of the run before the piece of the target\n"
                             "that ends at the newest knot"},
    MemberRow<&Summary::unmet>{
        "unmet", FieldWriter::owner,
        "number of waypoints of the run before those that the open entry passes over"},
    MemberRow<&Summary::blend_until>{"blend until", FieldWriter::owner,
                                     "ns: no entry of the run ends before this time"},
    MemberRow<&Summary::passed_over>{"passed over", FieldWriter::owner,
                                     "number of waypoints that entries pass over"},
    MemberRow<&Summary::consumed>{"consumed", FieldWriter::owner, "number of items consumed"},
    MemberRow<&Summary::knots>{"knots", FieldWriter::owner,
                               "number of waypoints accepted, replaced ones included"},
    MemberRow<&Summary::newest_time>{
        "newest time", FieldWriter::owner,
        "ns: time of the newest waypoint, or of the state in which a run begins"},
    MemberRow<&Summary::committed>{
        "committed", FieldWriter::owner,
        "ns: the solver's clock at the commit; of a recorded stream within some milliseconds"},
    MemberRow<&Summary::run_frozen>{
        "frozen", FieldWriter::owner,
        "number of waypoints of the run that were frozen when this revision was made"},
    MemberRow<&Summary::is_later_run>{
        "later run", FieldWriter::owner,
        "1: the run is not the first one of the stream, or begins in a given state"},
    MemberRow<&Summary::starved>{"starved", FieldWriter::owner,
                                 "1: the settled time of a live stream has passed its newest knot"},
    MemberRow<&Summary::low_water>{"least depth", FieldWriter::owner,
                                   "ns: smallest depth so far; 2⁶³ − 1: none yet"},
    MemberRow<&Summary::underruns>{"underruns", FieldWriter::owner,
                                   "number of times that the stream starved"},
    MemberRow<&Summary::deadline_misses>{
        "deadline misses", FieldWriter::owner,
        "number of revisions discarded because they were too late"},
    MemberRow<&Summary::late_commits>{
        "late commits", FieldWriter::owner,
        "number of revisions before this one that were committed too late"},
    MemberRow<&Summary::withdrawn>{"withdrawn", FieldWriter::owner, "items withdrawn unread"},
    MemberRow<&Summary::controls>{"controls", FieldWriter::owner,
                                  "replacements, start states and finishes carried out"},
    MemberRow<&Summary::exceeding>{
        "exceeding", FieldWriter::owner,
        "waypoints that brought the curve, or would have, beyond a limit"},
    MemberRow<&Summary::refused>{"refused", FieldWriter::owner, "items refused"},
    MemberRow<&Summary::reasons>{"reasons", FieldWriter::owner, "items refused, by reason"},
    MemberRow<&Summary::holders>{"holders", FieldWriter::owner,
                                 "number of stoppers that hold the stream"},
    MemberRow<&Summary::holder>{"holder", FieldWriter::owner, "slot of one of them; 0: none"},
    MemberRow<&Summary::longest_pause>{
        "longest pause", FieldWriter::owner,
        "ns: longest time in the last second by which a step was late, or took"},
    MemberRow<&Summary::end_kind>{
        "end kind", FieldWriter::owner,
        "1 as requested, 3 entry to the last waypoint, 4 or 5 in a stop; 0 none"},
    MemberRow<&Summary::end_item>{"end item", FieldWriter::owner,
                                  "number of the item that finished the stream"},
    MemberRow<&Summary::end_lateness>{
        "end lateness", FieldWriter::owner,
        "ns: how long after the last waypoint's time the curve rests at it"},
    MemberRow<&Summary::unmet_since>{
        "unmet since", FieldWriter::owner,
        "ns: time of the first waypoint after the last one that the curve meets;\n"
        "2⁶³ − 1: it meets the newest one, or may exceed its limits"},
    MemberRow<&Summary::refused_until>{
        "refused until", FieldWriter::owner,
        "ns: waypoints up to this time are refused as `cannot follow`; 2⁶³ − 1: none"},
    MemberRow<&Summary::outcomes>{"outcomes", FieldWriter::owner,
                                  "records of outcomes that were written"},
    MemberRow<&Summary::undecided>{
        "undecided", FieldWriter::owner,
        "first item of a waypoint that the curve neither meets nor has passed over;\n"
        "2⁶⁴ − 1: none"},
    MemberRow<&Summary::cut_off>{"cut off", FieldWriter::owner,
                                 "waypoints that the curve was on and a stopper's stop cut off"},
    padding(1)};

/// The words of a cell of the summary's slot. To add a field, add a member of Summary and a row
/// above; the rest follows from the row.
inline constexpr auto kSummaryRows = std::tuple_cat(kBoundsRows, kFurtherRows);
inline constexpr auto kSummaryFields = place(kSummaryRows);
inline constexpr std::size_t kSummaryWords = size_of(kSummaryFields).words;
static_assert(kSummaryWords % (kCacheLine / sizeof(Word)) == 0);

}  // namespace splinecast::ipc
