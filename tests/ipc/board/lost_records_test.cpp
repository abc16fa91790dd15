#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/roles/inspect.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Refusals and excesses of a revision that was not committed, because its writer died or discarded
/// it. A later revision consumes their items without a refusal and without an excess.
namespace splinecast::ipc {
namespace {

constexpr Word kItemsCommitted = 3000;  ///< by the last commit
constexpr Word kItemsLater = 2000;      ///< items that the later revision consumes

Word committed_item(Word back) { return kItemsCommitted - 1 - back; }

/// Writes `count` excesses of consecutive items, the newest one of item `newest`, from number
/// `index` on.
void write_excesses(KnotBoardWriter& writer, Word index, Word count, Word newest) {
  for (Word i = 0; i < count; ++i) {
    writer.write_excess(index + i, {.item = newest + 1 - count + i, .kind = LimitKind::jerk});
  }
}
void write_refusals(KnotBoardWriter& writer, Word index, Word count, Word newest) {
  for (Word i = 0; i < count; ++i) {
    writer.write_refusal(index + i, {.item = newest + 1 - count + i, .reason = Refusal::past});
  }
}

enum class Loss { death, discard };

/// A board that has committed more refusals and excesses than it keeps.
struct FullBoard : testing::MemoryBoard {
  Summary summary{.consumed = kItemsCommitted,
                  .exceeding = 2 * kExcessesKept + 7,
                  .refused = 2 * kRefusalsKept + 7};

  FullBoard() : MemoryBoard(1, 64) {
    write_excesses(writer, 0, summary.exceeding, committed_item(0));
    write_refusals(writer, 0, summary.refused, committed_item(0));
    writer.commit(summary);
  }
  void lose(Loss how) {
    if (how == Loss::death) replace_writer();
    if (how == Loss::discard) writer.discard();
  }
  void consume_later_items() {
    summary.consumed += kItemsLater;
    writer.commit(summary);
  }
  [[nodiscard]] std::vector<Word> excesses() const {
    std::vector<Word> items;
    for (Word i = summary.exceeding - kExcessesKept; i < summary.exceeding; ++i) {
      if (const auto found = reader.excess(summary, i)) items.push_back(found->item);
    }
    return items;
  }
  [[nodiscard]] std::vector<Word> refusals() const {
    std::vector<RefusalRecord> records(kRefusalsKept);
    records.resize(reader.copy_refusals(summary, 0, records));
    std::vector<Word> items;
    items.reserve(records.size());
    for (const RefusalRecord& record : records) items.push_back(record.item);
    return items;
  }
};

/// The items of the newest `count` records of a full board.
std::vector<Word> newest_items(Word count) {
  std::vector<Word> items;
  for (Word i = count; i > 0; --i) items.push_back(committed_item(i - 1));
  return items;
}

TEST(LostExcess, OfADeadOrDiscardedRevisionIsNotAccepted) {
  for (const Loss how : {Loss::death, Loss::discard}) {
    for (const Word lost : {Word{1}, Word{5}, Word{kExcessesKept}, Word{kExcessesKept + 9}}) {
      FullBoard board;
      write_excesses(board.writer, board.summary.exceeding, lost, kItemsCommitted - 1 + lost);
      const auto kept = newest_items(kExcessesKept - std::min<Word>(lost, kExcessesKept));
      EXPECT_EQ(board.excesses(), kept);
      board.lose(how);
      EXPECT_EQ(board.excesses(), kept);
      board.consume_later_items();
      EXPECT_EQ(board.excesses(), kept);
    }
  }
}

/// The stop of a curve whose waypoints have ended exceeds a limit: the excess has the item of the
/// last waypoint.
TEST(LostExcess, OfAStopIsNotAccepted) {
  for (const Loss how : {Loss::death, Loss::discard}) {
    FullBoard board;
    write_excesses(board.writer, board.summary.exceeding, 1, committed_item(0));
    write_excesses(board.writer, board.summary.exceeding + 1, 3, kItemsCommitted + 2);
    EXPECT_EQ(board.excesses(), newest_items(kExcessesKept - 4));
    board.lose(how);
    EXPECT_EQ(board.excesses(), newest_items(kExcessesKept - 4));
    board.consume_later_items();
    EXPECT_EQ(board.excesses(), newest_items(kExcessesKept - 4));
  }
}

TEST(LostExcess, IsClearedByTheNextWriterIfOneDiesMeanwhile) {
  FullBoard board;
  write_excesses(board.writer, board.summary.exceeding, 9, kItemsCommitted + 8);
  // The writer that took over has cleared the first records of those.
  const auto words =
      words_at(board.bytes.span(), board.layout.excesses, kExcessesKept * kExcessWords);
  for (Word i = 0; i < 4; ++i) {
    words[(board.summary.exceeding + i) % kExcessesKept * kExcessWords] = 0;
  }
  board.lose(Loss::death);
  board.consume_later_items();
  EXPECT_EQ(board.excesses(), newest_items(kExcessesKept - 9));
}

TEST(LostRefusals, OfADeadOrDiscardedRevisionAreNotAccepted) {
  for (const Loss how : {Loss::death, Loss::discard}) {
    for (const Word lost : {Word{1}, Word{5}, Word{kRefusalsKept}, Word{kRefusalsKept + 9}}) {
      FullBoard board;
      write_refusals(board.writer, board.summary.refused, lost, kItemsCommitted - 1 + lost);
      const auto kept = newest_items(kRefusalsKept - std::min<Word>(lost, kRefusalsKept));
      EXPECT_EQ(board.refusals(), kept);
      board.lose(how);
      EXPECT_EQ(board.refusals(), kept);
      board.consume_later_items();
      EXPECT_EQ(board.refusals(), kept);
    }
  }
}

TEST(LostRefusals, OfABoardThatHasFewAreOverwrittenOrCleared) {
  for (const Loss how : {Loss::death, Loss::discard}) {
    testing::MemoryBoard board(1, 64);
    Summary summary;
    write_refusals(board.writer, 0, kRefusalsKept + 1, kRefusalsKept);
    if (how == Loss::death) board.replace_writer();
    if (how == Loss::discard) board.writer.discard();
    board.writer.write_refusal(summary.refused++, {.item = 1500, .reason = Refusal::past});
    summary.consumed = kItemsLater;
    board.writer.commit(summary);
    std::vector<RefusalRecord> copied(kRefusalsKept);
    EXPECT_EQ(board.reader.copy_refusals(summary, 0, copied), 1U);
    EXPECT_EQ(copied[0].item, 1500U);
  }
}

/// A stream whose solver has died in a revision: `inspect` after another one has taken over and has
/// consumed the items.
StreamInfo info_after_death(const std::function<void(KnotBoardWriter&, Summary&)>& commit,
                            const std::function<void(KnotBoardWriter&, const Summary&)>& die) {
  const testing::TestStream stream;
  const MonotonicClock clock;
  constexpr Time kInterval{1'000'000};
  constexpr int kItems = 1100;
  Producer producer(stream.name(),
                    {.dimensions = 1, .clock = StreamClock::recorded, .capacity = 4096});
  Time time{};
  const auto append = [&] {
    for (int i = 0; i < kItems; ++i) {
      const double x = 0;
      EXPECT_EQ(producer.append({.time = time += kInterval, .position = {&x, 1}}),
                AppendStatus::accepted);
    }
  };
  const auto solve = [&] {
    Solver solver(stream.name(), {});
    solver.attach();
    while (solver.step(clock).consumed > 0) {
    }
  };
  append();
  solve();
  {
    auto board = open_board(stream.name(), true, {});
    KnotBoardWriter dies(board.region.bytes(), board.layout);
    Summary summary;
    EXPECT_TRUE(KnotBoardReader(board.region.bytes(), board.layout).copy_newest_summary(summary));
    EXPECT_EQ(summary.consumed, Word{kItems});
    commit(dies, summary);
    dies.commit(summary);
    die(dies, summary);
  }
  append();
  solve();
  StreamInfo info = inspect(stream.name());
  EXPECT_EQ(info.summary.consumed, Word{2} * kItems);
  return info;
}

TEST(LostExcess, IsNotShownByInspect) {
  const StreamInfo info = info_after_death(
      [](KnotBoardWriter& writer, Summary& summary) {
        summary.exceeding = kExcessesKept;
        write_excesses(writer, 0, kExcessesKept, summary.consumed - 1);
      },
      [](KnotBoardWriter& writer, const Summary& summary) {
        write_excesses(writer, kExcessesKept, 1, summary.consumed);
      });
  EXPECT_EQ(info.summary.exceeding, kExcessesKept);
  EXPECT_EQ(info.excesses.size(), kExcessesKept - 1);
  for (const LimitExcess& excess : info.excesses) EXPECT_LT(excess.item, 1100U);
}

TEST(LostRefusals, AreNotShownByInspect) {
  const StreamInfo info = info_after_death(
      [](KnotBoardWriter& writer, Summary& summary) {
        summary.refused = kRefusalsKept;
        write_refusals(writer, 0, kRefusalsKept, summary.consumed - 1);
      },
      [](KnotBoardWriter& writer, const Summary& summary) {
        write_refusals(writer, kRefusalsKept, kRefusalsKept, summary.consumed + kRefusalsKept - 1);
      });
  EXPECT_EQ(info.summary.refused, kRefusalsKept);
  EXPECT_TRUE(info.refusals.empty());
}

}  // namespace
}  // namespace splinecast::ipc
