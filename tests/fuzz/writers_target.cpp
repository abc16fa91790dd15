#include <optional>
#include <stdexcept>

#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"
#include "tests/fuzz/guarded_bytes.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/sampling.hpp"

namespace splinecast::fuzz {
namespace {

constexpr int kMostActions = 48;

/// Both regions of an image in memory, and the roles that take them over.
class Stream {
 public:
  explicit Stream(const StreamImage& image)
      : ring_bytes_(image.ring),
        board_bytes_(image.board),
        ring_header_(ipc::copy_header(ring_bytes_.span())),
        board_header_(ipc::copy_header(board_bytes_.span())),
        ring_layout_(ipc::checked_ring_layout(ring_header_, ring_bytes_.span().size())),
        board_layout_(ipc::checked_board_layout(board_header_, board_bytes_.span().size())),
        ring_(ring_bytes_.span(), ring_layout_),
        published_(board_bytes_.span(), board_layout_),
        sampler_(published_, ipc::stream_clock(board_header_), ipc::dimension_kinds(board_header_)),
        sampling_(published_, sampler_),
        state_(3 * ring_layout_.dimensions) {
    ipc::require_same_stream(ring_header_, board_header_);
    replace_solver();
    replace_producer();
    clock_.time = solver_->summary().committed;
  }

  void play(Script script) {
    step(script);
    for (int i = 0; i < kMostActions && !script.has_ended(); ++i) act(script);
    step(script);
    sampling_.tour();
  }

 private:
  void act(Script& script) {
    switch (script.byte() % 16) {
      case 0:
        return replace_solver();
      case 1:
        return replace_producer();
      case 2:
        return poke(ring_bytes_, script);
      case 3:
        return poke(board_bytes_, script);
      case 4:
        return (void)producer_->replace_from(script.near(producer_->last_time()), {}, solved());
      case 5:
        return replace(script);
      case 6:
        return start(script);
      case 7:
        return finish(script);
      case 8:
        return sampling_.tour();
      case 9:
      case 10:
      case 11:
        return step(script);
      default:
        return append(script);
    }
  }

  void replace_solver() {
    board_.emplace(board_bytes_.span(), board_layout_);
    solver_.emplace(ring_, *board_, published_, ipc::window_options(board_header_),
                    ipc::interval_range(ring_header_), ipc::dimension_kinds(ring_header_),
                    ipc::live_options(board_header_));
  }

  void replace_producer() {
    producer_.emplace(ring_bytes_.span(), ring_layout_, ipc::interval_range(ring_header_));
  }

  static void poke(GuardedBytes& bytes, Script& script) {
    const auto words = ipc::words_at(bytes.span(), 0, bytes.span().size() / sizeof(ipc::Word));
    const std::size_t at = script.below(words.size());
    words[at] = script.byte() % 2 == 0 ? words[at] + script.byte() : script.word();
  }

  [[nodiscard]] ipc::WaypointRingWriter::Solved solved() {
    ipc::WaypointRingWriter::Solved known{.consumed = published_.consumed()};
    const ipc::Look look = published_.look();
    const bool is_known = look.revision > 0 && is_time_in_range(look.settled_until);
    if (ipc::live_options(board_header_) && is_known) known.settled_until = look.settled_until;
    return known;
  }

  /// A waypoint near the time of the last one, with all derivatives that a method may need.
  Waypoint waypoint(Script& script) {
    for (double& value : state_) {
      const auto byte = script.byte();
      value = byte == 255 ? ipc::to_double(script.word()) : static_cast<std::int8_t>(byte) / 16.0;
    }
    const std::size_t dimensions = ring_layout_.dimensions;
    const std::span<const double> all(state_);
    return {.time = script.near(producer_->last_time()),
            .position = all.first(dimensions),
            .velocity = all.subspan(dimensions, dimensions),
            .acceleration = all.last(dimensions)};
  }

  void append(Script& script) { (void)producer_->append(waypoint(script), solved()); }

  void replace(Script& script) {
    Waypoint next = waypoint(script);
    const Time from = script.near(next.time);
    (void)producer_->replace_from(from, std::span(&next, 1), solved());
  }

  void start(Script& script) {
    const Waypoint at = waypoint(script);
    (void)producer_->start_from({.time = at.time,
                                 .position = at.position,
                                 .velocity = at.velocity,
                                 .acceleration = at.acceleration},
                                solved());
  }

  void finish(Script& script) {
    const auto kind = static_cast<ConditionKind>(script.byte() % 5);
    Condition end{.kind = kind, .value = {}};
    if (kind == ConditionKind::velocity || kind == ConditionKind::acceleration) {
      end.value.assign(ring_layout_.dimensions, static_cast<double>(script.byte()));
    }
    (void)producer_->finish(end, solved());
  }

  void step(Script& script) {
    const auto later = std::int64_t{script.byte()} << script.byte() % 24U;
    clock_.time += Time(later);
    const StepResult result = solver_->step(clock_);
    require(result.consumed <= ring_layout_.capacity, "a step takes at most one ring of items");
    sampling_.sample(sampling_.pick(script), false);
  }

  GuardedBytes ring_bytes_;
  GuardedBytes board_bytes_;
  ipc::RegionHeader ring_header_;
  ipc::RegionHeader board_header_;
  ipc::RingLayout ring_layout_;
  ipc::BoardLayout board_layout_;
  ipc::WaypointRingReader ring_;
  ipc::KnotBoardReader published_;
  std::optional<ipc::KnotBoardWriter> board_;
  std::optional<ipc::StreamSolver> solver_;
  std::optional<ipc::WaypointRingWriter> producer_;
  ipc::Sampler sampler_;
  Sampling sampling_;
  testing::FixedClock clock_;
  std::vector<double> state_;
};

}  // namespace

void try_writers(const StreamImage& image) {
  try {
    Stream stream(image);
    stream.play(Script(image.script));
  } catch (const BadRegion&) {
    return;  // refused
  } catch (const std::invalid_argument&) {
    return;  // refused: invalid options of a window
  }
}

}  // namespace splinecast::fuzz
