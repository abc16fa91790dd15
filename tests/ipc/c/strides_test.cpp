#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "ipc/arguments/guard.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/c/roles.hpp"
#include "tests/ipc/c/roles.hpp"

/// Values with strides are those without, and structs may have another size.
namespace splinecast {
namespace {

using testing::CState;
using testing::CStream;

/// A path of `kCount` waypoints in three derivatives, as contiguous rows.
struct Path {
  static constexpr std::size_t kCount = 12;
  static constexpr std::size_t kValues = kCount * 2;
  std::array<std::int64_t, kCount> times;
  std::array<double, kValues> positions, velocities, accelerations;

  Path() {
    for (std::size_t i = 0; i < kValues; ++i) {
      times[i / 2] = static_cast<std::int64_t>(i / 2) * CStream::kStep;
      positions[i] = static_cast<double>(i * i % 7);
      velocities[i] = 0.5 * static_cast<double>(i % 3);
      accelerations[i] = -0.25 * static_cast<double>(i % 5);
    }
  }
  [[nodiscard]] splinecast_waypoints plain() const {
    return {{times.data(), kCount, 0},
            {positions.data(), kCount, 2, 0, 0},
            {velocities.data(), kCount, 2, 2, 1},
            {accelerations.data(), kCount, 2, 0, 1}};
  }
};

/// The same path in memory with other strides.
struct OtherPath {
  std::vector<std::int64_t> times;
  std::vector<double> positions, velocities, accelerations;
  splinecast_waypoints waypoints;

  explicit OtherPath(const Path& path)
      : times(3 * Path::kCount), positions(100), velocities(100), accelerations(100) {
    for (std::size_t i = 0; i < Path::kCount; ++i) {
      times[3 * (Path::kCount - 1 - i)] = path.times[i];
      for (std::size_t d = 0; d < 2; ++d) {
        const std::size_t from = 2 * i + d;
        positions[d * Path::kCount + i] = path.positions[from];          // column-major
        velocities[5 * i + d] = path.velocities[from];                   // padded rows
        accelerations[99 - (4 * i + 2 * d)] = path.accelerations[from];  // backwards
      }
    }
    waypoints = {{&times[3 * (Path::kCount - 1)], Path::kCount, -3},
                 {positions.data(), Path::kCount, 2, 1, Path::kCount},
                 {velocities.data(), Path::kCount, 2, 5, 1},
                 {&accelerations[99], Path::kCount, 2, -4, -2}};
  }
};

splinecast_solver_options quintic() {
  splinecast_solver_options how = SPLINECAST_SOLVER_OPTIONS_INIT;
  how.method = "quintic";
  return how;
}

/// Requires that two streams have the same curve.
void expect_equal(const CStream& a, const CStream& b) {
  CState one(2), other(2);
  for (std::int64_t t = 0; t < 12 * CStream::kStep; t += 9'876'543) {
    ASSERT_EQ(splinecast_reader_preview(a.reader, t, &one.state),
              splinecast_reader_preview(b.reader, t, &other.state));
    ASSERT_EQ(one.values, other.values) << t;
  }
}

TEST(CStrides, DoNotChangeTheCurve) {
  const Path path;
  const OtherPath other(path);
  const splinecast_waypoints plain = path.plain();
  const CStream a(CStream::recorded(), quintic()), b(CStream::recorded(), quintic()),
      c(CStream::recorded(), quintic()), d(CStream::recorded(), quintic());
  ASSERT_EQ(splinecast_producer_append_many(a.producer, &plain, nullptr), 0);
  ASSERT_EQ(splinecast_producer_append_many(b.producer, &other.waypoints, nullptr), 0);
  ASSERT_EQ(splinecast_producer_replace_from(c.producer, -CStream::kStep, &other.waypoints, 0), 0);
  for (std::size_t i = 0; i < Path::kCount; ++i) {
    const splinecast_waypoint waypoint = {path.times[i],
                                          {&other.positions[i], 2, Path::kCount},
                                          {&other.velocities[5 * i], 2, 1},
                                          {&other.accelerations[99 - 4 * i], 2, -2}};
    ASSERT_EQ(splinecast_producer_append(d.producer, &waypoint), 0) << splinecast_last_error();
  }
  for (const CStream* stream : {&a, &b, &c, &d}) stream->solve();
  expect_equal(a, b);
  expect_equal(a, c);
  expect_equal(a, d);
}

TEST(CStrides, DoNotChangeAFit) {
  const Path path;
  const OtherPath other(path);
  const splinecast_waypoints plain = path.plain();
  splinecast_fit_options options = SPLINECAST_FIT_OPTIONS_INIT;
  options.method = "quintic";
  splinecast_curve *a = nullptr, *b = nullptr;
  ASSERT_EQ(splinecast_fit(&plain, &options, &a), 0) << splinecast_last_error();
  ASSERT_EQ(splinecast_fit(&other.waypoints, &options, &b), 0) << splinecast_last_error();
  for (std::size_t i = 0; i + 1 < Path::kCount; ++i) {
    splinecast_segment one = SPLINECAST_SEGMENT_INIT, same = SPLINECAST_SEGMENT_INIT;
    ASSERT_EQ(splinecast_curve_segment(a, i, &one), 0);
    ASSERT_EQ(splinecast_curve_segment(b, i, &same), 0);
    ASSERT_EQ(std::memcmp(one.coefficients.data, same.coefficients.data, 12 * sizeof(double)), 0);
  }
  splinecast_curve_destroy(a);
  splinecast_curve_destroy(b);
}

TEST(CStrides, OfOutputsLeaveWhatIsBetweenAlone) {
  const CStream c;
  c.send(20);
  CState plain(2);
  std::array<double, 12> memory;
  memory.fill(77);
  const splinecast_state strided = {
      {&memory[0], 2, 3}, {}, {&memory[11], 2, -4}, {&memory[1], 2, 1}};
  const std::int64_t t = 234'567'890;
  ASSERT_EQ(splinecast_reader_sample(c.reader, t, &plain.state),
            splinecast_reader_sample(c.reader, t, &strided));
  const auto& v = plain.values;
  EXPECT_EQ(memory, (std::array{v[0], v[6], v[7], v[1], 77., 77., 77., v[5], 77., 77., 77., v[4]}));
  memory.fill(77);
  EXPECT_FALSE(splinecast_has_values(splinecast_reader_sample(c.reader, -1, &strided)));
  for (const double value : memory) EXPECT_EQ(value, 77);
  splinecast_excess one = {}, other = {};
  splinecast_state turned = plain.state;
  std::array<double, 2> reversed{v[1], v[0]};
  turned.position = {&reversed[1], 2, -1};
  ASSERT_EQ(splinecast_reader_excess(c.reader, &plain.state, &one), 0);
  ASSERT_EQ(splinecast_reader_excess(c.reader, &turned, &other), 0);
  EXPECT_EQ(one.ratio, other.ratio);
}

TEST(CStrides, OfManySamplesLeaveWhatIsBetweenAlone) {
  const CStream c;
  c.send(20);
  const std::array<std::int64_t, 6> at{0, 9, 500'000'000, 9, 123'456'789, 9};
  const splinecast_times times = {at.data(), 3, 2};
  std::array<double, 24> plain{};
  std::array<double, 100> memory;
  memory.fill(77);
  const splinecast_output_matrix out = {plain.data(), 3, 8, 0, 0};
  const splinecast_output_matrix turned = {&memory[60], 3, 8, -30, 3};
  std::array<uint8_t, 3> statuses{};
  ASSERT_EQ(splinecast_reader_sample_many(c.reader, &times, SPLINECAST_ALL_VALUES, &out,
                                          statuses.data(), 3, nullptr),
            1);
  ASSERT_EQ(splinecast_reader_sample_many(c.reader, &times, SPLINECAST_ALL_VALUES, &turned,
                                          statuses.data(), 3, nullptr),
            1);
  std::size_t untouched = 0;
  for (const double value : memory) untouched += value == 77 ? 1U : 0U;
  EXPECT_EQ(untouched, memory.size() - plain.size());
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t d = 0; d < 8; ++d) EXPECT_EQ(memory[60 - 30 * i + 3 * d], plain[8 * i + d]);
  }
}

TEST(CStructs, OfALaterVersionAreTakenIfWhatIsUnknownIsZero) {
  struct Later {
    splinecast_producer_options known;
    std::int64_t unknown;
  } later = {CStream::recorded(), 0};
  later.known.size = sizeof later;
  const testing::TestStream stream;
  splinecast_producer* producer = nullptr;
  ASSERT_EQ(splinecast_producer_create(stream.name().c_str(), &later.known, &producer), 0)
      << splinecast_last_error();
  EXPECT_EQ(splinecast_producer_destroy(producer), 0);
  later.unknown = 1;
  EXPECT_EQ(splinecast_producer_create(stream.name().c_str(), &later.known, &producer),
            SPLINECAST_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(splinecast_last_error(), "options->size is"), nullptr);
}

/// A struct as its second version would be: the first had no `added`.
struct Grown {
  std::size_t size;
  std::int64_t value;
  std::int64_t added;
};

TEST(CStructs, OfAnEarlierVersionHaveTheDefaultsOfWhatTheyLack) {
  constexpr std::size_t kFirst = offsetof(Grown, added);
  const std::array<std::int64_t, 2> earlier{kFirst, 5};
  const auto* given = reinterpret_cast<const Grown*>(earlier.data());
  const Grown found = ipc::read_struct(given, Grown{sizeof(Grown), 1, 7}, "given", kFirst);
  EXPECT_EQ(found.value, 5);
  EXPECT_EQ(found.added, 7);
  EXPECT_THROW((void)ipc::read_struct(given, Grown{}, "given"), ipc::BadArgument);
  std::array<std::int64_t, 3> out{kFirst, 0, 77};
  ipc::write_struct(Grown{sizeof(Grown), 8, 9}, reinterpret_cast<Grown*>(out.data()));
  EXPECT_EQ(out, (std::array<std::int64_t, 3>{kFirst, 8, 77}));
}

TEST(CStructs, EndWithoutPaddingThatALaterMemberCouldFill) {
  const auto is_end = [](std::size_t offset, std::size_t member, std::size_t whole) {
    return offset + member == whole;
  };
#define ENDS_WITH(type, member) \
  EXPECT_TRUE(is_end(offsetof(type, member), sizeof(type::member), sizeof(type))) << #type
  ENDS_WITH(splinecast_limits, upper);
  ENDS_WITH(splinecast_refusal, by);
  ENDS_WITH(splinecast_refusals, consumed);
  ENDS_WITH(splinecast_producer_options, start_tolerance);
  ENDS_WITH(splinecast_preview, motion_jerk);
  ENDS_WITH(splinecast_solver_options, largest_rate);
  ENDS_WITH(splinecast_step_result, reserved);
  ENDS_WITH(splinecast_reader_options, owner);
  ENDS_WITH(splinecast_progress, reserved);
  ENDS_WITH(splinecast_law_rate, slope);
  ENDS_WITH(splinecast_rate_commander_options, reserved);
  ENDS_WITH(splinecast_stopper_options, reserved);
  ENDS_WITH(splinecast_segment, reserved);
  ENDS_WITH(splinecast_fit_options, end);
#undef ENDS_WITH
}

}  // namespace
}  // namespace splinecast
