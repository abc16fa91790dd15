#include "ipc/verification/verify.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/online/extrapolation.hpp"
#include "ipc/solve/run_edges.hpp"

namespace splinecast::ipc {
namespace {

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

std::string text(Time time) { return std::to_string(time.count()) + " ns"; }

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
        end_(record.items.dimensions()),
        extrapolation_(record.items.dimensions()),
        values_(3 * record.items.dimensions()) {}

  Verification run() {
    while (!first_ && next_ < segments_.size()) solve_part();
    if (!first_ && record_.head.finished && !rests_at_last_waypoint()) {
      (void)expect_all_used(record_.items.size());
    }
    return {.equal = equal_, .first = std::move(first_)};
  }

 private:
  /// A knot of a run that the curve meets, and the newest knot when it was last solved.
  struct MetKnot {
    std::size_t index;
    std::size_t newest;
  };

  [[nodiscard]] const SegmentCopy& before(std::size_t i) const noexcept { return segments_[i - 1]; }

  /// Whether segment i follows an entry beyond the newest waypoint: the line, or the stop.
  [[nodiscard]] bool is_behind_entry(std::size_t i) const noexcept {
    if (i == 0 || segments_[i].has_waypoint || segments_[i].number != before(i).number + 1) {
      return false;
    }
    const bool follows_line = before(i).kind == SegmentKind::spline && !before(i).has_waypoint;
    const bool follows_entry = before(i).kind == SegmentKind::splice && before(i).origin.known > 0;
    return (follows_entry && segments_[i].kind != SegmentKind::splice) ||
           (follows_line && segments_[i].kind == SegmentKind::stop_tail);
  }

  [[nodiscard]] bool is_entry(std::size_t i) const noexcept {
    return segments_[i].kind == SegmentKind::splice && segments_[i].origin.item &&
           (segments_[i].origin.ends_at_waypoint || segments_[i].origin.known > 0);
  }

  [[nodiscard]] bool begins_run(std::size_t i) const noexcept {
    const SegmentCopy& segment = segments_[i];
    if (i == 0) return true;
    if (is_entry(i)) return !run_item_ || *run_item_ != *segment.origin.item;
    return segment.kind == SegmentKind::stop_tail && !segment.has_waypoint && !is_behind_entry(i);
  }

  void solve_part() {
    const std::size_t i = next_;
    if (!follows(i)) return;
    if (is_ending(i)) return solve_ending(i);
    if (begins_run(i)) return solve_run(i);
    if (segments_[i].kind == SegmentKind::hold && !segments_[i].has_waypoint) return solve_hold(i);
    (void)differ(i, "kind: it belongs to no run", text(segments_[i].kind), "none");
  }

  /// Whether a segment takes up where the one before it ends.
  bool follows(std::size_t i) {
    const SegmentCopy& segment = segments_[i];
    const Word number = i > 0 ? segments_[i - 1].next : segment.number;
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

  /// Whether segment i is the entry by which a curve ends at its last waypoint.
  [[nodiscard]] bool is_ending(std::size_t i) const noexcept {
    return i + 1 == segments_.size() && record_.head.finished && !is_entry(i) &&
           segments_[i].kind == SegmentKind::splice;
  }

  /// Whether the entry that ends the curve is the first one of its run.
  [[nodiscard]] bool begins_at_end(std::size_t i) const noexcept {
    return is_ending(i) && segments_[i].origin.item && run_item_ != segments_[i].origin.item;
  }

  void solve_ending(std::size_t i) {
    if (begins_at_end(i) && !begin_run(i)) return;
    if (run_item_ && !append_until(record_.head.run_knots)) return;
    if (window_.knots() == 0) {
      return (void)differ(i, "kind: it belongs to no run", text(segments_[i].kind), "none");
    }
    find_state(i);
    const core::Knot knot = window_.knot(window_.knots() - 1);
    std::ranges::fill(values_, 0.0);
    const auto zeros = std::span(values_).first(window_.dimensions());
    core::build_splice(state_at(segments_[i].left),
                       {segments_[i].natural_right, knot.position, zeros, zeros}, solved_);
    if (compare(i)) advance();
  }

  /// The segments of one run: those on its target, and the entries that lead there.
  void solve_run(std::size_t i) {
    if (!begin_run(i)) return;
    const std::size_t end = end_of_run(i);
    if (!list_met(i, end)) return;
    for (std::size_t s = i; s < end; ++s) {
      if (!follows(s) || !solve_in_run(s)) return;
      advance();
    }
    if (window_.knots() > 0 && is_last_run()) (void)append_until(record_.head.run_knots);
  }

  /// Whether the curve was cut where segment i begins for the waypoints that follow: else they came
  /// later, behind a stop.
  [[nodiscard]] bool begins_at_cut(std::size_t i) const noexcept {
    if (!segments_[i].origin.item) return true;
    Word item = *segments_[i].origin.item;
    while (item > 0 && !record_.items.is_taken(item - 1, ItemKind::replace)) --item;
    return item > 0 && record_.items.waypoint(item - 1).time == segments_[i].left;
  }

  [[nodiscard]] bool is_last_run() const noexcept {
    return record_.head.finished && run_item_ && *run_item_ + 1 == record_.head.run_item;
  }

  /// Whether the first run of the record does not begin with the stream's first waypoint: a state
  /// was given, or the curve was replaced before it had begun to move.
  [[nodiscard]] bool begins_elsewhere(const SegmentCopy& segment) const noexcept {
    if (segment.has_waypoint) return false;
    const Word items = record_.items.size();
    if (record_.items.find(ItemKind::start_state, 0, items)) return true;
    const auto has_item = [](const SegmentCopy& s) { return s.origin.item.has_value(); };
    const auto entry = std::ranges::find_if(segments_, has_item);
    const Word first = entry != segments_.end() ? *entry->origin.item : items;
    const auto waypoint = record_.items.find(ItemKind::waypoint, 0, first);
    return waypoint && record_.items.find(ItemKind::replace, *waypoint, first).has_value();
  }

  bool begin_run(std::size_t i) {
    const SegmentCopy& segment = segments_[i];
    const Word items = record_.items.size();
    find_state(i);
    const bool is_later = i > 0 || begins_elsewhere(segment);
    // A run that has no waypoint yet is the same wherever it is cut again.
    const Word first_items = segment.origin.item.value_or(items);
    const bool is_same_run =
        i > 0 && window_.knots() == 0 &&
        (window_.is_later_run() || !record_.items.find(ItemKind::replace, 0, first_items));
    if (is_later && !is_same_run) window_.begin_run();
    if (!is_same_run || begins_at_cut(i)) {
      run_position_.assign(state_.position().begin(), state_.position().end());
    }
    met_.clear();
    frozen_met_ = 0;
    run_items_.clear();
    run_item_ = segment.origin.item;
    if (!run_item_ && segment.has_waypoint)
      run_item_ = record_.items.find(ItemKind::waypoint, used_, items);
    if (!run_item_) return true;
    if (!expect_all_used(*run_item_)) return false;
    list_items(*run_item_);
    return true;
  }

  /// Lists the waypoints of the run that begins with an item. One that is not later than the one
  /// before was not taken, but withdrawn unread with all behind it.
  void list_items(Word first) {
    const Word items = record_.items.size();
    const Word replaced = record_.items.find(ItemKind::replace, first, items).value_or(items);
    run_items_.clear();
    for (Word item = first;;) {
      const auto next = record_.items.find(ItemKind::waypoint, item, replaced);
      if (!next) return;
      const Time time = record_.items.waypoint(*next).time;
      if (!run_items_.empty() && time <= record_.items.waypoint(run_items_.back()).time) return;
      run_items_.push_back(*next);
      item = *next + 1;
    }
  }

  [[nodiscard]] std::size_t end_of_run(std::size_t i) const noexcept {
    std::size_t end = i + 1;
    while (end < segments_.size() && !begins_run(end) && !is_ending(end)) ++end;
    return end;
  }

  /// The waypoint of the run at a time.
  [[nodiscard]] std::optional<std::size_t> index_of(Time time) const noexcept {
    const auto time_of = [this](Word item) { return record_.items.waypoint(item).time; };
    const auto at = std::ranges::lower_bound(run_items_, time, {}, time_of);
    if (at == run_items_.end() || time_of(*at) != time) return std::nullopt;
    return static_cast<std::size_t>(at - run_items_.begin());
  }

  /// Lists the knots that segments of a run meet, with what they say of when they were solved.
  bool list_met(std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const SegmentCopy& segment = segments_[s];
      if (segment.has_waypoint && !note_met(s, segment.left, segment.newer_knots)) return false;
      const bool arrives =
          segment.origin.ends_at_waypoint && segment.kind != SegmentKind::stop_tail;
      if (arrives && !note_met(s, segment.natural_right, segment.origin.right_newer_knots)) {
        return false;
      }
    }
    return true;
  }

  bool note_met(std::size_t s, Time time, std::size_t newer) {
    const auto index = index_of(time);
    if (!index) return differ(s, "waypoint", text(time), "none of the run at that time");
    if (met_.empty() || met_.back().index < *index) met_.push_back({*index, 0});
    // Said twice where there is a segment on both sides: of a knot behind a cut only once.
    if (met_.back().index == *index) met_.back().newest = *index + newer;
    return true;
  }

  /// Appends waypoints of the run until it has `count` knots, and freezes before each what it did
  /// not change.
  bool append_until(std::size_t count) {
    while (window_.knots() < count) {
      const std::size_t k = window_.knots();
      if (k >= run_items_.size()) {
        return differ(next_, "waypoints known", std::to_string(count), std::to_string(k));
      }
      for (; frozen_met_ < met_.size() && met_[frozen_met_].newest < k; ++frozen_met_) {
        window_.freeze_knots(met_[frozen_met_].index + 1);
      }
      append(run_items_[k]);
      used_ = run_items_[k] + 1;
    }
    return true;
  }

  /// Solves and compares segment s of the present run.
  bool solve_in_run(std::size_t s) {
    const SegmentCopy& segment = segments_[s];
    if (is_entry(s)) return solve_entry(s);
    if (is_behind_entry(s)) return solve_behind_entry(s);
    if (segment.kind == SegmentKind::hold && !segment.has_waypoint) {
      evaluate_at_cut(cut_of(before(s)), segment.left, state_);
      core::build_hold(segment.left, segment.right, state_.position(), solved_);
      return compare(s);
    }
    if (!segment.has_waypoint) return solve_state_stop(s);
    const auto index = index_of(segment.left);
    if (!index) return differ(s, "left end", text(segment.left), "no waypoint");
    const bool is_stop = segment.kind == SegmentKind::stop_tail;
    const auto newest = newest_of(is_stop ? *index : *index + 1);
    if (!append_until((newest ? *newest : *index) + 1)) return false;
    finish_if_last();
    if (*index >= window_.segments()) {
      return differ(s, "kind: it belongs to no run", text(segment.kind), "none");
    }
    window_.segment(*index, solved_);
    if (!compare(s)) return false;
    if (same_bits(window_.knot(*index).waypoint, segment.waypoint)) return true;
    return differ(s, "waypoint", first_of(segment.waypoint),
                  first_of(window_.knot(*index).waypoint));
  }

  [[nodiscard]] std::optional<std::size_t> newest_of(std::size_t index) const noexcept {
    const auto at = std::ranges::lower_bound(met_, index, {}, &MetKnot::index);
    if (at == met_.end() || at->index != index) return std::nullopt;
    return at->newest;
  }

  /// The stop from the state that a run begins in.
  bool solve_state_stop(std::size_t s) {
    const core::WindowOptions& options = window_.options();
    const Time length = core::stop_time_within(options.limits, options.stop_time, state_.velocity(),
                                               state_.acceleration());
    core::build_stop(segments_[s].left, length, state_.position(), state_.velocity(),
                     state_.acceleration(), solved_);
    return compare(s);
  }

  bool solve_entry(std::size_t s) {
    const SegmentCopy& segment = segments_[s];
    find_state(s);
    Instant end = state_at(segment.natural_right);
    if (segment.origin.ends_at_waypoint) {
      const auto index = index_of(segment.natural_right);
      if (!index) return differ(s, "right end", text(segment.natural_right), "no waypoint");
      if (!append_until(*index + segment.newer_knots + 1)) return false;
      window_.freeze_knots(*index + 1);
      const core::Knot knot = window_.knot(*index);
      window_.write_acceleration(*index, end_.ref().acceleration);
      end.position = knot.position;
      end.velocity = knot.velocity;
    } else {
      if (!append_until(segment.origin.known)) return false;
      extrapolation_.begin(window_);
      extrapolation_.state_at(end.time, end_.ref());
      end.position = end_.position();
      end.velocity = end_.velocity();
      behind_ = {
          .end = end.time, .line_end = extrapolation_.line_end(), .rest = extrapolation_.rest()};
    }
    end.acceleration = end_.acceleration();
    core::build_splice(state_at(segment.left), end, solved_);
    return compare(s);
  }

  bool solve_behind_entry(std::size_t s) {
    const auto position = std::span(values_).first(window_.dimensions());
    const bool is_line = segments_[s].kind == SegmentKind::spline;
    behind_.write_line_end(end_.position(), end_.velocity(), position);
    if (is_line) {
      core::build_segment(core::SegmentForm::cubic,
                          {behind_.end, end_.position(), end_.velocity(), {}, {}},
                          {behind_.line_end, position, end_.velocity(), {}, {}}, solved_);
    } else {
      core::build_stop(behind_.stop_begin(), behind_.stop_length(),
                       behind_.has_line() ? position : end_.position(), end_.velocity(),
                       end_.acceleration(), solved_);
    }
    return compare(s);
  }

  void finish_if_last() noexcept {
    const bool is_last = is_last_run() && window_.knots() == record_.head.run_knots;
    if (!is_last || window_.finished()) return;
    window_.freeze_knots(record_.head.run_frozen);
    if (window_.frozen_knots() < window_.knots()) window_.finish(record_.end);
  }

  /// Whether no segment leads to the last run, as the curve rests where that ends already.
  bool rests_at_last_waypoint() {
    const Word run_item = record_.head.run_item;
    if (segments_.empty() || run_item == 0 || run_item_ == run_item - 1) return false;
    if (!expect_all_used(run_item - 1)) return false;
    evaluate_at_cut(cut_of(segments_.back()), segments_.back().right, state_);
    run_position_.assign(state_.position().begin(), state_.position().end());
    window_.begin_run();
    met_.clear();
    list_items(run_item - 1);
    return append_until(record_.head.run_knots) && window_.knots() > 0 &&
           same_bits(window_.knot(window_.knots() - 1).position, state_.position());
  }

  /// No waypoint may lie between what is on the curve and item `end`, unless it was replaced.
  bool expect_all_used(Word end) {
    const auto missed = record_.items.find(ItemKind::waypoint, used_, end);
    if (!missed || record_.items.find(ItemKind::replace, *missed, end)) return true;
    const std::size_t last = segments_.empty() ? 0 : std::min(next_, segments_.size() - 1);
    return differ(last, std::string("waypoint of item ") + std::to_string(*missed), "none",
                  text(record_.items.waypoint(*missed).time));
  }

  void append(Word item) noexcept {
    const Waypoint sent = record_.items.waypoint(item);
    const std::size_t dimensions = window_.dimensions();
    const auto copy = [&](std::size_t part, std::span<const double> from) {
      const auto to = std::span(values_).subspan(part * dimensions, from.size());
      std::ranges::copy(from, to.begin());
      return to;
    };
    const WaypointValues values{.position = copy(0, sent.position),
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
    return window_.is_later_run() ? std::span<const double>(run_position_)
                                  : std::span<const double>{};
  }

  /// Finds the state that the entry, or the stop, of segment i begins in.
  void find_state(std::size_t i) noexcept {
    const SegmentCopy& segment = segments_[i];
    if (i == 0) {
      const auto start = record_.items.find(ItemKind::start_state, 0, record_.items.size());
      start ? take_item(*start) : take_state_of(segment);
      return;
    }
    const bool begins_on_knot =
        segment.left == natural_right_ &&
        (before(i).kind == SegmentKind::spline || before(i).kind == SegmentKind::splice);
    if (begins_on_knot) return take_state_of(segment);
    CutSegment cut = cut_of(before(i));
    cut.right = natural_right_;
    evaluate_at_cut(cut, segment.left, state_);
    normalise();
    for (int n = 1; n < kNormalisations && !is_state_of(segment); ++n) normalise();
  }

  [[nodiscard]] Instant state_at(Time t) const noexcept {
    return {.time = t,
            .position = state_.position(),
            .velocity = state_.velocity(),
            .acceleration = state_.acceleration()};
  }

  [[nodiscard]] static CutSegment cut_of(const SegmentCopy& segment) noexcept {
    return {segment.left, segment.right, segment.order, segment.coefficients};
  }

  void normalise() noexcept {
    const StateRef state = state_.ref();
    record_.kinds.normalise_quaternions(state.position, state.velocity, state.acceleration);
  }

  void take_item(Word item) noexcept {
    const Waypoint start = record_.items.waypoint(item);
    std::ranges::copy(start.position, state_.ref().position.begin());
    std::ranges::copy(start.velocity, state_.ref().velocity.begin());
    std::ranges::copy(start.acceleration, state_.ref().acceleration.begin());
  }

  void take_state_of(const SegmentCopy& segment) noexcept {
    core::evaluate(segment.order, segment.coefficients, 0, state_.ref());
    // Evaluation makes a negative 0 positive.
    std::ranges::copy(std::span(segment.coefficients).first(window_.dimensions()),
                      state_.ref().position.begin());
  }

  [[nodiscard]] bool is_state_of(const SegmentCopy& segment) const {
    State state(window_.dimensions());
    core::evaluate(segment.order, segment.coefficients, 0, state.ref());
    const bool may_step = segment.kind == SegmentKind::stop_tail;
    return same_bits(state.position(), state_.position()) &&
           same_bits(state.velocity(), state_.velocity()) &&
           (may_step || same_bits(state.acceleration(), state_.acceleration()));
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
  State state_;  ///< that an entry, or the stop of a run, begins in
  State end_;    ///< that an entry ends in
  core::Extrapolation extrapolation_;
  BehindEntry behind_;
  std::vector<double> values_;
  std::vector<double> run_position_;  ///< where the present run begins
  std::optional<Word> run_item_{};
  std::vector<Word> run_items_;  ///< of the present run's waypoints
  std::vector<MetKnot> met_;     ///< of the present run
  std::size_t frozen_met_ = 0;   ///< those of them that have been frozen
  Time natural_right_{};         ///< of the segment before, had it not been cut
  std::size_t next_ = 0;         ///< segment to be compared next
  std::size_t equal_ = 0;
  Word used_ = 0;  ///< items before this one are known to the curve, or replaced
  std::optional<Difference> first_;
};

}  // namespace

Verification verify(const StreamRecord& record) { return Resolver(record).run(); }

}  // namespace splinecast::ipc
