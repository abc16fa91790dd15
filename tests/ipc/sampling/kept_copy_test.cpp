/// A writer may publish between any two loads of a reader. Here it publishes between the loads of
/// the two tags of a slot: with 64 dimensions the cells of one slot are on different pages, and the
/// first access to one of these pages triggers the writer.

#include <gtest/gtest.h>

#include <vector>

#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/processes/trapped_page.hpp"
#include "tests/fixtures/streams/board_words.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryBoard;
using testing::TrappedPage;

constexpr std::size_t kDimensions = kMaxDimensions;
constexpr Time kInterval{100};

/// The two cells of this knot are on different pages. No other knot has a cell on these pages.
constexpr Word kKnot = 7;
constexpr Word kFirst = kKnot - 2;
constexpr Word kNewest = kKnot + 1;

Time time_of(Word number) { return kInterval * static_cast<int>(number); }

/// A board whose knots have the number of their revision as velocity.
struct Board : MemoryBoard {
  Board() : MemoryBoard(kDimensions, 16) {}

  void write() {
    const std::vector<double> zeros(kDimensions);
    const std::vector<double> velocity(kDimensions, static_cast<double>(writer.revision() + 1));
    for (Word number = kFirst; number <= kNewest; ++number) {
      const bool is_newest = number == kNewest;
      writer.write(number,
                   {.is_new = writer.revision() == 0,
                    .note = {.form = is_newest ? core::SegmentForm::none : core::SegmentForm::cubic,
                             .is_waypoint = true},
                    .time = time_of(number),
                    .begins = time_of(number),
                    .position = zeros,
                    .velocity = velocity});
    }
  }
  void commit() {
    Summary summary{.first = kFirst, .newest = kNewest};
    writer.commit(summary);
  }
  void publish() {
    write();
    commit();
  }
  Look look() { return reader.look(); }
  /// The tag of a cell of the knot's slot.
  void* tag(std::size_t cell) {
    return bytes.span().data() + testing::cell_offset(layout, kKnot, cell);
  }
};

/// Publishes all knots in revisions 1 to r = `copied` + 1; a reader sees r. At the first access to
/// cell `trapped` the writer publishes r + 1 and begins r + 2.
class Interleaving {
 public:
  Interleaving(Word copied, std::size_t trapped) : trapped_(trapped) {
    for (Word r = 1; r <= copied; ++r) board.publish();
  }

  /// The result of `look` when r is current: the revision of the values that it read, or 0.
  template <typename Look>
  Word run(const Look& look) {
    board.publish();
    const TrappedPage page(board.tag(trapped_), [&] {
      board.publish();
      board.write();
    });
    const Word seen = look();
    has_acted = page.has_acted();
    return seen;
  }

  Board board;
  bool has_acted = false;

 private:
  std::size_t trapped_;
};

template <typename Test>
void for_each_interleaving(const Test& test) {
  for (const Word copied : {2U, 3U}) {
    for (std::size_t trapped = 0; trapped < 2; ++trapped) {
      SCOPED_TRACE(::testing::Message()
                   << "copied under " << copied << ", trap at cell " << trapped);
      test(copied, trapped);
    }
  }
}

TEST(KeptCopy, TheCellsOfTheKnotAreOnDifferentPages) {
  const Board board;
  const auto page_of = [&](std::size_t c) {
    return testing::cell_offset(board.layout, kKnot, c) / kPage;
  };
  EXPECT_NE(page_of(0), page_of(1));
}

TEST(KeptCopy, IsNotCurrentIfTwoRevisionsAreWrittenBetweenTheTagLoads) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving at(copied, trapped);
    KnotCopy copy(kDimensions, false);
    ASSERT_TRUE(at.board.reader.copy_knot(kKnot, copied, copy));
    const Word seen =
        at.run([&] { return at.board.reader.is_current(copy, copied + 1) ? copy.tag : 0; });
    EXPECT_EQ(seen, 0U);
    // The other cell's tag alone shows that the copy is not current: the reader does not access the
    // copy's own cell.
    EXPECT_EQ(at.has_acted, trapped != copy.cell);
  });
}

TEST(KeptCopy, IsEmptyIfTwoRevisionsAreWrittenBetweenTheTagLoads) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving knots(copied, trapped);
    KnotCopy copy(kDimensions, false);
    const Word knot = knots.run([&] {
      return knots.board.reader.copy_knot(kKnot, copied + 1, copy)
                 ? static_cast<Word>(copy.velocity()[0])
                 : 0;
    });
    EXPECT_TRUE(knots.has_acted);
    EXPECT_EQ(knot, 0U);
    EXPECT_FALSE(copy.is_there());
    Interleaving times(copied, trapped);
    Time time{};
    core::SegmentForm form{};
    EXPECT_FALSE(times.run([&] {
      return static_cast<Word>(times.board.reader.copy_time(kKnot, copied + 1, time, form));
    })) << time.count();
  });
}

TEST(KeptCopy, ASampleIsNeverOfARevisionOlderThanItsBounds) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving at(copied, trapped);
    Sampler sampler(at.board.reader, StreamClock::recorded);
    State state(kDimensions);
    const Time t = time_of(kKnot);
    ASSERT_TRUE(has_values(sampler.sample(t, state.ref())));
    ASSERT_EQ(state.velocity()[0], static_cast<double>(copied));
    const Word seen = at.run([&] {
      EXPECT_TRUE(has_values(sampler.sample(t, state.ref())));
      return static_cast<Word>(state.velocity()[0]);
    });
    EXPECT_TRUE(at.has_acted);
    EXPECT_EQ(seen, sampler.revision_seen());
  });
}

TEST(KeptCopy, ASegmentNeverCombinesKnotsOfTwoRevisions) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    for (const Word number : {kKnot - 1, kKnot}) {
      Interleaving at(copied, trapped);
      BoardSegment segment(kDimensions, false);
      Summary summary;
      const Word seen = at.run([&] {
        EXPECT_TRUE(at.board.reader.copy_bounds(at.board.look(), 0, summary));
        return static_cast<Word>(segment.take(at.board.reader, summary, number));
      });
      EXPECT_TRUE(at.has_acted);
      EXPECT_EQ(seen, static_cast<Word>(BoardSegment::Taken::torn));
      EXPECT_FALSE(segment.is_there());
    }
  });
}

/// The writer publishes after the first time is evaluated: all times are evaluated again.
TEST(KeptCopy, SampleManyReturnsOneRevisionAlthoughTheWriterPublishesMeanwhile) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving at(copied, trapped);
    Sampler sampler(at.board.reader, StreamClock::recorded);
    const std::vector<Time> times{time_of(kFirst), time_of(kKnot), time_of(kFirst)};
    std::vector<double> values(times.size() * kDimensions);
    std::vector<SampleStatus> status(times.size(), SampleStatus::busy);
    const SampleBlock out{values, status, Derivatives::velocity};
    ASSERT_EQ(sampler.sample_many(times, out), copied);
    const Word seen = at.run([&] { return sampler.sample_many(times, out); });
    EXPECT_TRUE(at.has_acted);
    EXPECT_EQ(seen, copied + 2);
    for (const double value : values) EXPECT_EQ(value, static_cast<double>(seen));
    for (const SampleStatus each : status) EXPECT_TRUE(has_values(each));
  });
}

}  // namespace
}  // namespace splinecast::ipc
