#include "splinecast/ipc/verification.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <vector>

#include "splinecast/ipc/run_edges.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentKind;

/// How often a state may have been put to unit length by runs that took each other's place.
constexpr int kNormalisations = 4;

bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(std::span<const double> a, std::span<const double> b) noexcept {
  return std::ranges::equal(a, b, [](double x, double y) { return same_bits(x, y); });
}

/// The shortest text that reads back exactly.
std::string text(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string text(core::Time time) { return std::to_string(time.count()) + " ns"; }

std::string text(SegmentKind kind) {
  constexpr std::array<const char*, 4> kNames{"spline", "splice", "stop tail", "hold"};
  const auto i = static_cast<std::size_t>(kind);
  return i < kNames.size() ? kNames[i] : "unknown";
}

std::string first_of(std::span<const double> values) {
  return std::string("[").append(text(values[0])).append(", …]");
}

/// Solves the record of one stream again.
class Resolver {
 public:
  explicit Resolver(const StreamRecord& record)
      : record_(record),
        segments_(record.segments),
        window_(record.items.dimensions(), record.window),
        solved_(record.items.dimensions()),
        state_(record.items.dimensions()),
        values_(3 * record.items.dimensions()) {}

  Verification run() {
    while (!first_ && next_ < segments_.size()) solve_part();
    if (!first_ && record_.head.finished) (void)expect_all_used(record_.items.size());
    return {.equal = equal_, .first = std::move(first_)};
  }

 private:
  /// The decisions of one run, as its segments record them.
  struct Run {
    std::size_t first = 0;     ///< its first segment, in the record
    std::size_t segments = 0;  ///< of it that are left
    bool is_entered = false;
    bool is_last = false;               ///< the one that was finished
    std::size_t entry = 0;              ///< newest knot when the splice was last shaped
    std::vector<std::size_t> newest{};  ///< by knot: newest knot when it was last solved
    std::size_t end = 0;                ///< knots that are needed
  };

  [[nodiscard]] bool begins_run(std::size_t i) const noexcept {
    const SegmentCopy& segment = segments_[i];
    return i == 0 || segment.origin.item ||
           (segment.kind == SegmentKind::stop_tail && !segment.has_waypoint);
  }

  void solve_part() {
    const std::size_t i = next_;
    if (!follows(i)) return;
    if (begins_run(i)) return solve_run(i);
    if (segments_[i].kind == SegmentKind::hold && !segments_[i].has_waypoint) return solve_hold(i);
    solve_way_back(i);
  }

  /// Whether a segment takes up where the one before it ends.
  bool follows(std::size_t i) {
    const SegmentCopy& segment = segments_[i];
    const Word number = i > 0 ? segments_[i - 1].next : 1;
    if (segment.number != number) {
      return differ(i, "number: segments between were lost before they were collected",
                    std::to_string(segment.number), std::to_string(number));
    }
    if (i == 0 || segment.left == segments_[i - 1].right) return true;
    return differ(i, "left end", text(segment.left), text(segments_[i - 1].right));
  }

  void solve_hold(std::size_t i) {
    evaluate_at_cut(cut_of(segments_[i - 1]), segments_[i].left, state_);
    core::build_hold(segments_[i].left, segments_[i].right, state_.position(), solved_);
    if (segments_[i].left != natural_right_) {
      (void)differ(i, "left end", text(segments_[i].left), text(natural_right_));
    } else if (compare(i)) {
      advance();
    }
  }

  void solve_way_back(std::size_t i) {
    const bool is_last = i + 1 == segments_.size() && record_.head.finished;
    if (!is_last || window_.knots() == 0 || segments_[i].kind != SegmentKind::splice) {
      return (void)differ(i, "kind: it belongs to no run", text(segments_[i].kind), "none");
    }
    const core::Knot knot = window_.knot(window_.knots() - 1);
    const auto way = way_back(window_, knot, solved_, state_);
    if (!way) return (void)differ(i, "kind", text(segments_[i].kind), "none: at rest there");
    build_way_back(*way, segments_[i].left, state_.position(), knot.position, solved_);
    if (compare(i)) advance();
  }

  void solve_run(std::size_t i) {
    const Run run = decisions_of(i);
    begins_on_knot_ = i > 0 && segments_[i].left == natural_right_ &&
                      (segments_[i - 1].kind == SegmentKind::spline ||
                       segments_[i - 1].kind == SegmentKind::splice);
    if (run.is_entered) enter(i);
    if (run.newest.empty()) {
      for (std::size_t s = 0; s < run.segments && compare_of_run(run, s); ++s) advance();
      return;
    }
    const Word first = first_item(run);
    if (!expect_all_used(first)) return;
    const Word items = record_.items.size();
    if (replaced_ <= first) {
      replaced_ = record_.items.find(ItemKind::replace, first, items).value_or(items);
    }
    Word item = first;
    for (std::size_t k = 0; k < run.end; ++k) {
      freeze(run, k);
      const Word from = item + (k > 0 ? 1 : 0);
      const auto next = record_.items.find(ItemKind::waypoint, from, replaced_);
      if (!next) {
        return (void)differ(next_, "newer knots seen", std::to_string(run.end - 1), "no waypoint");
      }
      item = *next;
      append(item);
      if (k < run.newest.size()) used_ = item + 1;
      if (k + 1 == run.end && run.is_last) finish();
      if (!compare_at(run, k)) return;
    }
  }

  [[nodiscard]] Run decisions_of(std::size_t i) const {
    Run run{.first = i, .segments = 1, .is_entered = !segments_[i].has_waypoint};
    while (i + run.segments < segments_.size() && segments_[i + run.segments].has_waypoint) {
      ++run.segments;
    }
    run.is_last = record_.head.finished && segments_[i].number == record_.head.run;
    for (std::size_t s = 0; s < run.segments; ++s) {
      const SegmentCopy& segment = segments_[i + s];
      const std::size_t knot = run.newest.size();
      if (s == 0 && !run.is_entered) run.newest.push_back(segment.newer_knots);
      const bool has_right =
          segment.kind == SegmentKind::spline || segment.kind == SegmentKind::splice;
      if (s == 0 && run.is_entered) run.entry = has_right ? segment.newer_knots : 0;
      if (has_right) run.newest.push_back(run.newest.size() + segment.origin.right_newer_knots);
      // Said twice where there is a segment on both sides: of a knot behind a cut only once.
      if (s > 0 && knot > 0) run.newest[knot - 1] = knot - 1 + segment.newer_knots;
    }
    for (const std::size_t newest : run.newest) run.end = std::max(run.end, newest + 1);
    if (!run.newest.empty()) run.end = std::max(run.end, run.entry + 1);
    return run;
  }

  [[nodiscard]] Word first_item(const Run& run) const noexcept {
    if (segments_[run.first].origin.item) return *segments_[run.first].origin.item;
    return record_.items.find(ItemKind::waypoint, used_, record_.items.size())
        .value_or(record_.items.size());
  }

  /// No waypoint may lie between what is on the curve and item `end`, unless it was replaced.
  bool expect_all_used(Word end) {
    const auto missed = record_.items.find(ItemKind::waypoint, used_, end);
    if (!missed || record_.items.find(ItemKind::replace, *missed, end)) return true;
    const std::size_t last = segments_.empty() ? 0 : std::min(next_, segments_.size() - 1);
    return differ(last, std::string("waypoint of item ") + std::to_string(*missed), "none",
                  text(record_.items.waypoint(*missed).time));
  }

  /// Before knot k comes: what it did not change.
  void freeze(const Run& run, std::size_t k) noexcept {
    std::size_t count = std::min(window_.frozen_knots(), run.newest.size());
    while (count < run.newest.size() && run.newest[count] < k) ++count;
    // While its entry is open nothing of a run is frozen.
    if (run.is_entered) count = run.entry < k ? std::max<std::size_t>(count, 1) : 0;
    window_.freeze_knots(count);
  }

  void append(Word item) noexcept {
    const core::Waypoint sent = record_.items.waypoint(item);
    const std::size_t dimensions = window_.dimensions();
    const auto copy = [&](std::size_t part, std::span<const double> from) {
      const auto to = std::span(values_).subspan(part * dimensions, from.size());
      std::ranges::copy(from, to.begin());
      return to;
    };
    const core::WaypointValues values{.position = copy(0, sent.position),
                                      .velocity = copy(1, sent.velocity),
                                      .acceleration = copy(2, sent.acceleration)};
    record_.kinds.continue_from(newest_position(), values);
    window_.append({.time = sent.time,
                    .position = values.position,
                    .velocity = values.velocity,
                    .acceleration = values.acceleration});
  }

  [[nodiscard]] std::span<const double> newest_position() const noexcept {
    if (window_.knots() > 0) return window_.knot(window_.knots() - 1).waypoint;
    return window_.is_entered() ? window_.entry().state().position : std::span<const double>{};
  }

  void finish() noexcept {
    window_.freeze_knots(record_.head.run_frozen);
    if (window_.frozen_knots() < window_.knots()) window_.finish(record_.end);
  }

  void enter(std::size_t i) noexcept {
    const SegmentCopy& segment = segments_[i];
    if (i == 0) {
      const auto start = record_.items.find(ItemKind::start_state, 0, record_.items.size());
      start ? take_item(*start) : take_state_of(segment);
    } else if (begins_on_knot_) {
      take_state_of(segment);
    } else {
      CutSegment before = cut_of(segments_[i - 1]);
      before.right = natural_right_;
      evaluate_at_cut(before, segment.left, state_);
      normalise();
      for (int n = 1; n < kNormalisations && !is_state_of(segment); ++n) normalise();
    }
    window_.enter({.time = segment.left,
                   .position = state_.position(),
                   .velocity = state_.velocity(),
                   .acceleration = state_.acceleration()},
                  standing_before(i));
  }

  [[nodiscard]] static CutSegment cut_of(const SegmentCopy& segment) noexcept {
    return {segment.left, segment.right, segment.order, segment.coefficients};
  }

  /// The last waypoints before segment i, oldest first.
  [[nodiscard]] std::span<const core::StandingWaypoint> standing_before(std::size_t i) noexcept {
    std::size_t found = 0;
    for (int k = 0; k < kStandingLookBack && i > 0 && found < standing_.size(); ++k) {
      const SegmentCopy& at = segments_[--i];
      if (!at.has_waypoint) continue;
      ++found;
      standing_[standing_.size() - found] = {at.left, at.waypoint};
    }
    return std::span(standing_).last(found);
  }

  void normalise() noexcept {
    const core::StateRef state = state_.ref();
    record_.kinds.normalise_quaternions(state.position, state.velocity, state.acceleration);
  }

  void take_item(Word item) noexcept {
    const core::Waypoint start = record_.items.waypoint(item);
    std::ranges::copy(start.position, state_.ref().position.begin());
    std::ranges::copy(start.velocity, state_.ref().velocity.begin());
    std::ranges::copy(start.acceleration, state_.ref().acceleration.begin());
  }

  void take_state_of(const SegmentCopy& segment) noexcept {
    core::evaluate(segment.order, segment.coefficients, 0, state_.ref());
  }

  [[nodiscard]] bool is_state_of(const SegmentCopy& segment) const {
    core::State state(window_.dimensions());
    core::evaluate(segment.order, segment.coefficients, 0, state.ref());
    return same_bits(state.position(), state_.position()) &&
           same_bits(state.velocity(), state_.velocity()) &&
           same_bits(state.acceleration(), state_.acceleration());
  }

  /// The newest knot with which a segment of a run was last changed.
  [[nodiscard]] static std::size_t changed_by(const Run& run, std::size_t s) noexcept {
    const std::size_t right = run.is_entered ? s : s + 1;
    if (right >= run.newest.size()) return run.end - 1;
    return s == 0 && run.is_entered ? std::max(run.entry, run.newest[0]) : run.newest[right];
  }

  /// Compares the segments that nothing behind knot k has changed.
  bool compare_at(const Run& run, std::size_t k) {
    while (next_ < run.first + run.segments && changed_by(run, next_ - run.first) <= k) {
      if (!compare_of_run(run, next_ - run.first)) return false;
      advance();
    }
    return true;
  }

  bool compare_of_run(const Run& run, std::size_t s) {
    if (!follows(run.first + s)) return false;
    if (s >= window_.segments()) {
      return differ(run.first + s, "kind: it belongs to no run",
                    text(segments_[run.first + s].kind), "none");
    }
    window_.segment(s, solved_);
    if (!compare(run.first + s)) return false;
    const auto left = window_.left_knot(s);
    const SegmentCopy& published = segments_[run.first + s];
    if (!left || same_bits(window_.knot(*left).waypoint, published.waypoint)) return true;
    return differ(run.first + s, "waypoint", first_of(published.waypoint),
                  first_of(window_.knot(*left).waypoint));
  }

  /// Whether a segment ends where it was solved to, or was cut there.
  [[nodiscard]] bool may_end(std::size_t i) const noexcept {
    if (segments_[i].right == solved_.right) return true;
    const bool may_be_cut = i + 1 < segments_.size() || !record_.head.finished;
    return may_be_cut && segments_[i].right > solved_.left && segments_[i].right < solved_.right;
  }

  bool compare(std::size_t i) {
    const SegmentCopy& published = segments_[i];
    if (published.left != solved_.left) {
      return differ(i, "left end", text(published.left), text(solved_.left));
    }
    if (!may_end(i)) return differ(i, "right end", text(published.right), text(solved_.right));
    if (published.kind != solved_.kind) {
      return differ(i, "kind", text(published.kind), text(solved_.kind));
    }
    if (published.order != solved_.order) {
      return differ(i, "order", std::to_string(published.order), std::to_string(solved_.order));
    }
    const std::size_t count = static_cast<std::size_t>(solved_.order) * window_.dimensions();
    return compare(i, "coefficient", std::span(published.coefficients).first(count),
                   solved_.coefficients);
  }

  /// Compares values [power][dimension].
  bool compare(std::size_t i, const std::string& what, std::span<const double> published,
               std::span<const double> solved) {
    for (std::size_t k = 0; k < published.size(); ++k) {
      if (same_bits(published[k], solved[k])) continue;
      const std::size_t dimensions = window_.dimensions();
      const bool has_powers = published.size() > dimensions;
      std::string which = what;
      if (has_powers) which.append(" ").append(std::to_string(k / dimensions));
      which.append(" of dimension ").append(std::to_string(k % dimensions));
      return differ(i, std::move(which), text(published[k]), text(solved[k]));
    }
    return true;
  }

  void advance() noexcept {
    natural_right_ = solved_.right;
    ++next_;
    ++equal_;
  }

  bool differ(std::size_t i, std::string what, std::string published, std::string solved) {
    first_.emplace(Difference{
        .what = std::move(what), .published = std::move(published), .solved = std::move(solved)});
    if (i < segments_.size()) {
      first_->segment = segments_[i].number;
      first_->left = segments_[i].left;
      first_->right = segments_[i].right;
    }
    return false;
  }

  const StreamRecord& record_;
  std::span<const SegmentCopy> segments_;
  core::SlidingWindow window_;
  core::Segment solved_;
  core::State state_;
  std::vector<double> values_;
  StandingWaypoints standing_{};
  core::Time natural_right_{};  ///< of the segment before, had it not been cut
  bool begins_on_knot_ = false;
  std::size_t next_ = 0;  ///< segment to be compared next
  std::size_t equal_ = 0;
  Word used_ = 0;      ///< items before this one are on the curve, or replaced
  Word replaced_ = 0;  ///< the replacement that ends the run; items.size(): none does
  std::optional<Difference> first_;
};

}  // namespace

Verification verify(const StreamRecord& record) { return Resolver(record).run(); }

}  // namespace splinecast::ipc
