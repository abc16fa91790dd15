/// Between any two loads of a reader, a writer may publish. Here it does so between the loads of
/// the two tags of a slot: with 64 dimensions the cells of a slot lie on different pages, and the
/// first access to one of them lets the writer act.

#include <gtest/gtest.h>

#include <vector>

#include "splinecast/ipc/sampler.hpp"
#include "support/memory_stream.hpp"
#include "support/trapped_page.hpp"

namespace splinecast::ipc {
namespace {

using core::Time;
using testing::MemoryBoard;
using testing::TrappedPage;

constexpr std::size_t kDimensions = core::kMaxDimensions;
const Time kLeft{100};
const Time kRight{200};

/// A board with one segment, all of whose coefficients are the revision that wrote it.
struct Board : MemoryBoard {
  Board() : MemoryBoard(kDimensions, 4) {}

  void write(Word revision) {
    core::Segment segment(kDimensions);
    segment.left = kLeft;
    segment.right = kRight;
    segment.order = core::kCubicOrder;
    std::ranges::fill(segment.coefficients, static_cast<double>(revision));
    const std::vector<double> zeros(kDimensions);
    writer.write(1, segment,
                 {.time = {},
                  .prefix = {},
                  .newer_knots = 0,
                  .waypoint = zeros,
                  .g = zeros,
                  .position = zeros,
                  .velocity = zeros,
                  .acceleration = {},
                  .residual = {}});
  }
  void commit() {
    Head head{.first = 1, .newest = 1, .settled_until = kLeft};
    writer.commit(head);
  }
  void publish(Word revision) {
    write(revision);
    commit();
  }
  /// The tag of a cell of the segment's slot.
  void* tag(std::size_t cell) {
    return bytes.span().data() + layout.slots + layout.stride + cell * layout.cell;
  }
};

/// One segment published under `copied` and again under r = `copied` + 1, which a reader sees. At
/// the first access to cell `trapped` the writer publishes r + 1 and begins r + 2.
class Interleaving {
 public:
  Interleaving(Word copied, std::size_t trapped) : copied_(copied), trapped_(trapped) {
    for (Word r = 1; r <= copied; ++r) board.publish(r);
  }

  /// What `look` gives under r; the revision that it takes the segment's values to be of, 0 if
  /// none.
  template <typename Look>
  Word run(const Look& look) {
    board.publish(copied_ + 1);
    const TrappedPage page(board.tag(trapped_), [&] {
      board.publish(copied_ + 2);
      board.write(copied_ + 3);
    });
    const Word seen = look();
    has_acted = page.has_acted();
    return seen;
  }

  Board board;
  bool has_acted = false;

 private:
  Word copied_;
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

TEST(KeptCopy, IsNotCurrentWhenTwoRevisionsPassBetweenTheLoadsOfTheTags) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving at(copied, trapped);
    SegmentCopy copy(kDimensions);
    ASSERT_TRUE(at.board.reader.copy_segment(1, copied, copy));
    const Word seen =
        at.run([&] { return at.board.reader.is_current(copy, copied + 1) ? copy.tag : 0; });
    EXPECT_EQ(seen, 0U);
    // The other cell holds r: where the writer does not act there, no second look is needed.
    EXPECT_EQ(at.has_acted, trapped != copy.cell);
  });
}

TEST(KeptCopy, IsOfTheRevisionAskedForOrNoneWhenTwoRevisionsPassBetweenTheTags) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving segments(copied, trapped);
    SegmentCopy copy(kDimensions);
    const Word segment = segments.run([&] {
      return segments.board.reader.copy_segment(1, copied + 1, copy)
                 ? static_cast<Word>(copy.coefficients[0])
                 : 0;
    });
    EXPECT_TRUE(segments.has_acted);
    EXPECT_EQ(segment, 0U);
    Interleaving ends(copied, trapped);
    Time left{};
    Time right{};
    EXPECT_FALSE(ends.run([&] {
      return static_cast<Word>(ends.board.reader.copy_ends(1, copied + 1, left, right));
    })) << right.count();
  });
}

TEST(KeptCopy, ASampleIsNeverOfARevisionOlderThanItsBounds) {
  for_each_interleaving([](Word copied, std::size_t trapped) {
    Interleaving at(copied, trapped);
    Sampler sampler(at.board.reader, StreamClock::recorded);
    core::State state(kDimensions);
    ASSERT_TRUE(has_values(sampler.sample(kLeft, state.ref())));
    ASSERT_EQ(state.position()[0], static_cast<double>(copied));
    const Word seen = at.run([&] {
      EXPECT_TRUE(has_values(sampler.sample(kLeft, state.ref())));
      return static_cast<Word>(state.position()[0]);
    });
    EXPECT_TRUE(at.has_acted);
    EXPECT_EQ(seen, sampler.revision_seen());
  });
}

}  // namespace
}  // namespace splinecast::ipc
