#include "apps/timing/histogram.hpp"

#include <gtest/gtest.h>

#include <string>

#include "apps/timing/hgrm.hpp"
#include "apps/timing/percentiles.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

/// The times of tests/data/histogram.hgrm: Park and Miller's generator over 20 octaves.
Histogram reference_times() {
  Histogram histogram;
  std::int64_t x = 1;
  for (int i = 0; i < 20'000; ++i) {
    x = x * 48271 % 2147483647;
    histogram.record(Time(500 + x % (std::int64_t{1} << (10 + i % 20))));
  }
  return histogram;
}

TEST(Histogram, CellsPartitionTheTimesToThreeDigits) {
  std::int64_t next = 0;
  for (std::size_t cell = 0; cell < 20'000; ++cell) {
    EXPECT_EQ(Histogram::first_of(cell), next);
    const std::int64_t width = Histogram::last_of(cell) - next + 1;
    EXPECT_LE((width - 1) * 1024, next);
    for (const std::int64_t ns : {next, Histogram::last_of(cell)}) {
      Histogram one;
      one.record(Time(ns));
      EXPECT_EQ(one.counts().size(), cell + 1) << ns;
    }
    next += width;
  }
}

TEST(Histogram, KeepsExactExtremesAndClampsTimesOutOfRange) {
  Histogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.mean(), 0);
  histogram.record(Time(123'457));
  EXPECT_EQ(histogram.least(), Time(123'457));
  histogram.record(Time(-5));
  histogram.record(Time::max());
  EXPECT_EQ(histogram.least(), Time(0));
  EXPECT_EQ(histogram.greatest(), Time(Histogram::kLongest));
  EXPECT_EQ(histogram.at_rank(1), Time(0));
  // The cell of 123457 is 64 ns wide.
  EXPECT_EQ(histogram.at_rank(2), Time(123'457 / 64 * 64 + 63));
  EXPECT_EQ(histogram.at_rank(3), histogram.greatest());
}

TEST(Histogram, ItsPercentileTextEqualsThatOfHdrHistogramByteForByte) {
  const std::string wanted =
      testing::read_file(std::string(SPLINECAST_SOURCE) + "/tests/data/histogram.hgrm");
  ASSERT_FALSE(wanted.empty());
  EXPECT_EQ(percentile_text(reference_times()), wanted);
}

TEST(Percentile, IsTheTimeAtItsRankAndCountsTheTimesAbove) {
  Histogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.record(Time(i));
  EXPECT_EQ(percentile_of(histogram, 50'000).value, Time(500));
  EXPECT_EQ(percentile_of(histogram, 50'000).above, 500U);
  EXPECT_EQ(percentile_of(histogram, 99'000).value, Time(990));
  EXPECT_EQ(percentile_of(histogram, 99'900).value, Time(999));
  EXPECT_EQ(percentile_of(histogram, 99'999).value, Time(1000));
  EXPECT_EQ(percentile_of(histogram, 99'999).above, 0U);
  Histogram lone;
  lone.record(Time(7));
  for (const std::uint64_t thousandths : kPercentiles) {
    EXPECT_EQ(percentile_of(lone, thousandths).value, Time(7));
  }
}

TEST(Percentile, HasEnoughSamplesWithTenAboveAndNotWithNine) {
  Histogram histogram;
  for (int i = 1; i <= 999; ++i) histogram.record(Time(i));
  EXPECT_EQ(percentile_of(histogram, 99'000).above, 9U);
  EXPECT_FALSE(percentile_of(histogram, 99'000).has_enough());
  histogram.record(Time(1000));
  EXPECT_EQ(percentile_of(histogram, 99'000).above, 10U);
  EXPECT_TRUE(percentile_of(histogram, 99'000).has_enough());
}

}  // namespace
}  // namespace splinecast::apps
