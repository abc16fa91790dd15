#include <gtest/gtest.h>

#include "tests/fixtures/streams/threaded_stream.hpp"

namespace splinecast::testing {
namespace {

TEST(Threads, ReadersAndObserversOfOneMappingGetWholePayloadsDuringTakeovers) {
  const ThreadedCounts counts = run_threads({});
  RecordProperty("appended", std::to_string(counts.appended));
  RecordProperty("replacements", std::to_string(counts.replacements));
  RecordProperty("takeovers", std::to_string(counts.takeovers));
  RecordProperty("revisions", std::to_string(counts.revisions));
  RecordProperty("samples", std::to_string(counts.samples));
  RecordProperty("busy", std::to_string(counts.busy));
  RecordProperty("snapshots", std::to_string(counts.snapshots));
  RecordProperty("observed", std::to_string(counts.observed));
  RecordProperty("overwritten", std::to_string(counts.overwritten));
  RecordProperty("torn_samples", std::to_string(counts.torn_samples));
  RecordProperty("torn_snapshots", std::to_string(counts.torn_snapshots));
  RecordProperty("torn_items", std::to_string(counts.torn_items));
  EXPECT_EQ(counts.torn_samples, 0U);
  EXPECT_EQ(counts.torn_snapshots, 0U);
  EXPECT_EQ(counts.torn_items, 0U);
  EXPECT_GT(counts.replacements, 0U);
  EXPECT_GT(counts.takeovers, 0U);
}

}  // namespace
}  // namespace splinecast::testing
