#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <string>

#include "ipc/layout/board_control.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "tests/fixtures/streams/threaded_stream.hpp"

/// Runs a stream's threads with one of its words as plain memory:
///   splinecast_plain_word none|WORD
/// Built with ThreadSanitizer, which must report a race for each WORD and none for `none`.
namespace {

using namespace splinecast;
using testing::MemoryStream;

const ipc::Word* word_at(std::span<std::byte> region, std::size_t offset, std::size_t word) {
  return &ipc::words_at(region, offset, word + 1)[word];
}

/// A word of each kind that readers load while its writer stores.
const std::map<std::string, std::function<const ipc::Word*(MemoryStream&)>>& words() {
  const auto of_board = [](std::size_t ipc::BoardLayout::*part, std::size_t word) {
    return [part, word](MemoryStream& stream) {
      return word_at(stream.board.bytes.span(), stream.board.layout.*part, word);
    };
  };
  const auto of_slot = [](std::size_t ipc::BoardLayout::*part, std::size_t word) {
    return [part, word](MemoryStream& stream) {
      const ipc::BoardLayout& layout = stream.board.layout;
      return word_at(stream.board.bytes.span(), layout.slots + layout.*part, word);
    };
  };
  const auto of_ring = [](std::size_t ipc::RingLayout::*part, std::size_t word) {
    return [part, word](MemoryStream& stream) {
      return word_at(stream.ring.bytes.span(), stream.ring.layout.*part, word);
    };
  };
  static const std::map<std::string, std::function<const ipc::Word*(MemoryStream&)>> all{
      {"none", [](MemoryStream&) { return nullptr; }},
      {"tag", of_board(&ipc::BoardLayout::slots, ipc::kCellTag)},
      {"velocity", of_board(&ipc::BoardLayout::slots, ipc::kCellVelocity)},
      {"node", of_slot(&ipc::BoardLayout::nodes, ipc::kNodePosition)},
      {"acceleration", of_slot(&ipc::BoardLayout::beside, ipc::kBesideAcceleration)},
      {"summary-tag", of_board(&ipc::BoardLayout::control, ipc::kSummarySlot)},
      {"summary-slot", of_board(&ipc::BoardLayout::control,
                                ipc::kSummarySlot + ipc::word_of(ipc::kSummaryFields, "newest"))},
      {"changed-from", of_board(&ipc::BoardLayout::control, ipc::kChanges)},
      {"settled-until", of_board(&ipc::BoardLayout::control, ipc::kSettledUntil)},
      {"knot-time", of_board(&ipc::BoardLayout::times, 0)},
      {"revision", of_board(&ipc::BoardLayout::control, ipc::kRevision)},
      {"consumed", of_board(&ipc::BoardLayout::control, ipc::kConsumed)},
      {"written", of_ring(&ipc::RingLayout::control, ipc::kWritten)},
      {"claimed", of_ring(&ipc::RingLayout::control, ipc::kClaimed)},
      {"item", of_ring(&ipc::RingLayout::items, ipc::kItemValues)}};
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const auto chosen = words().find(argc == 2 ? argv[1] : "");
  if (chosen == words().end()) {
    std::fputs("usage: splinecast_plain_word none", stderr);
    for (const auto& [name, word] : words()) std::fprintf(stderr, "|%s", name.c_str());
    std::fputs("\n", stderr);
    return 2;
  }
  const testing::ThreadedCounts counts = testing::run_threads(
      {}, [&](MemoryStream& stream) { ipc::plain_word = chosen->second(stream); });
  std::printf("%llu items, %llu revisions, %llu samples\n",
              static_cast<unsigned long long>(counts.appended),
              static_cast<unsigned long long>(counts.revisions),
              static_cast<unsigned long long>(counts.samples));
  return counts.torn_samples + counts.torn_snapshots + counts.torn_items == 0 ? 0 : 1;
}
