#include "fuzz/guarded_bytes.hpp"
#include "fuzz/region_targets.hpp"
#include "fuzz/sampling.hpp"
#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/settled_segments.hpp"
#include "splinecast/ipc/stream_options.hpp"

namespace splinecast::fuzz {
namespace {

constexpr int kMostActions = 64;

/// Looks at all of a board that `info` and a producer look at.
void look_around(const ipc::SegmentBoardReader& board) {
  ipc::Head head;
  const ipc::Word r = board.revision();
  (void)board.copy_head(r, head);
  for (const ipc::Word seen : {r, r - 1, r - ipc::kHeadChangesKept, ipc::Word{0}}) {
    (void)board.copy_bounds(r, seen, head);
  }
  for (ipc::Word i = 0; i < 3; ++i) (void)board.refusal(head.refused - i);
  (void)(board.tail() + (board.sleeping() ? 1U : 0U));
}

void play(Script& script, GuardedBytes& bytes, const ipc::SegmentBoardReader& board,
          Sampling& sampling) {
  ipc::SettledSegments settled(board);
  for (int i = 0; i < kMostActions && !script.has_ended(); ++i) {
    switch (script.byte() % 8) {
      case 0:
        sampling.snapshot(sampling.pick(script), sampling.pick(script));
        break;
      case 1:
        look_around(board);
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
    const ipc::SegmentBoardReader board(bytes.span(), layout);
    ipc::Sampler sampler(board, ipc::stream_clock(header), ipc::dimension_kinds(header));
    Sampling sampling(board, sampler);
    look_around(board);
    sampling.tour();
    Script script(image.script);
    play(script, bytes, board, sampling);
    sampling.tour();
  } catch (const ipc::BadRegion&) {
    // Refused: that is an answer.
    return;
  }
}

}  // namespace splinecast::fuzz
