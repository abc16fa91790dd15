#include <array>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/old_motion.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "tests/fuzz/guarded_bytes.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/sampling.hpp"

namespace splinecast::fuzz {
namespace {

constexpr int kMostActions = 64;

/// Reads everything on a board that `info` and a producer read.
void read_everything(const ipc::KnotBoardReader& board) {
  ipc::Summary summary;
  const ipc::Look look = board.look();
  const ipc::Word r = look.revision;
  (void)board.copy_summary(look, summary);
  for (const ipc::Word seen : {r, r - 1, r - ipc::kChangesKept, ipc::Word{0}}) {
    (void)board.copy_bounds(look, seen, summary);
  }
  std::array<ipc::RefusalRecord, 3> refused{};
  require(board.copy_refusals(summary, 0, refused) <= refused.size(),
          "refusals fit into their array");
  for (const ipc::Word back : {ipc::Word{1}, ipc::Word{9}, ipc::Word{ipc::kOutcomesKept}}) {
    if (const auto record = board.outcome(summary.outcomes - back)) (void)record->is_of(r);
  }
  (void)board.outcomes_lost();
  (void)ipc::segment_before(board, summary, summary.newest);
  (void)board.step_times();
  (void)(board.consumed() + (board.sleeping() ? 1U : 0U));
}

/// Samples several times with one call, mostly in increasing order.
void look_ahead(Script& script, Sampling& sampling) {
  std::vector<Time> times(script.byte() % 40);
  Time t = sampling.pick(script);
  const auto step = static_cast<ipc::Word>(script.byte()) << script.byte() % 32U;
  for (Time& time : times) {
    time = t;
    t = ipc::to_time(ipc::to_word(t) + step);
  }
  if (!times.empty() && script.byte() % 4 == 0) times.back() = sampling.pick(script);
  const auto asked = 1 + script.byte() % static_cast<int>(Derivatives::all);
  sampling.sample_many(times, static_cast<Derivatives>(asked));
}

void play(Script& script, GuardedBytes& bytes, const ipc::KnotBoardReader& board,
          Sampling& sampling) {
  ipc::SettledSegments settled(board);
  for (int i = 0; i < kMostActions && !script.has_ended(); ++i) {
    switch (script.byte() % 9) {
      case 0:
        sampling.snapshot(sampling.pick(script), sampling.pick(script));
        break;
      case 1:
        read_everything(board);
        break;
      case 2:
        settled.look();
        break;
      case 3:
      case 4: {
        const auto words = ipc::words_at(bytes.span(), 0, bytes.span().size() / sizeof(ipc::Word));
        const std::size_t at = script.below(words.size());
        bytes.set_writable(true);
        words[at] = script.byte() % 2 == 0 ? words[at] + script.byte() : script.word();
        bytes.set_writable(false);
        break;
      }
      case 5:
        look_ahead(script, sampling);
        break;
      case 6:
        sampling.sample(sampling.pick(script), true);
        break;
      default:
        sampling.sample(sampling.pick(script), false);
    }
  }
}

}  // namespace

void try_reader(const StreamImage& image) {
  GuardedBytes bytes(image.board);
  bytes.set_writable(false);
  try {
    const ipc::RegionHeader header = ipc::copy_header(bytes.span());
    const auto layout = ipc::checked_board_layout(header, bytes.span().size());
    const ipc::KnotBoardReader board(bytes.span(), layout);
    ipc::Sampler sampler(board, ipc::stream_clock(header), ipc::dimension_kinds(header));
    Sampling sampling(board, sampler);
    read_everything(board);
    (void)ipc::end_of_motion(header, board, {});
    sampling.tour();
    Script script(image.script);
    play(script, bytes, board, sampling);
    sampling.tour();
  } catch (const BadRegion&) {
    return;  // refused
  }
}

}  // namespace splinecast::fuzz
