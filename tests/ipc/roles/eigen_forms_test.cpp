#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "splinecast/eigen.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/streams/recorded_roles.hpp"

/// The forms in which a user of Eigen writes waypoints, states and horizons, on real streams.
namespace splinecast {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::kPace;
using testing::RecordedRoles;
template <int Rows, int Columns>
using RowMajorXd = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;

/// Values of a user's program, and what appends them in each form.
struct Forms {
  VectorXd x = Vector3d(1, 2, 3), v = Vector3d(0.5, -1, 2), a = Vector3d(0, 0.25, 4);
  Vector3d fixed{3, 1, 2};
  MatrixXd columns = MatrixXd::Random(3, 4), wide = MatrixXd::Random(4, 3);
  RowMajorXd<Eigen::Dynamic, Eigen::Dynamic> rows = wide;
  double dt = 0.01;
  std::array<double, 3> plain{7, 8, 9};
  std::array<double, 6> pairs{1, 0, 2, 0, 4, 0};

  /// Calls `send` with a waypoint in each form, and with the position that it has.
  template <typename Send>
  void append(RecordedRoles& stream, const Send& send) const {
    append_vectors(stream, send);
    append_temporaries(stream, send);
    append_parts(stream, send);
  }

  template <typename Send>
  void append_vectors(RecordedRoles& stream, const Send& send) const {
    send(as_waypoint(stream.next(), x), x);
    send(as_waypoint(stream.next(), x, v), x);
    send(as_waypoint(stream.next(), x, v, a), x);
    send(as_waypoint(stream.next(), x + v * dt), x + v * dt);
    send(as_waypoint(stream.next(), x, v + a * dt, 2 * a), x);
    send(as_waypoint(stream.next(), x.cwiseMin(1.5), VectorXd::Zero(3)), x.cwiseMin(1.5));
    send(Waypoint{.time = stream.next(), .position = x}, x);
    send(Waypoint{.time = stream.next(), .position = fixed, .velocity = v}, fixed);
    send(as_waypoint(stream.next(), fixed), fixed);
    send(as_waypoint(stream.next(), Vector3d(1, 2, 3)), x);
    send(as_waypoint(stream.next(), columns * Eigen::Vector4d(1, 2, 3, 4)),
         columns * Eigen::Vector4d(1, 2, 3, 4));
    send(as_waypoint(stream.next(), x.array() + 1), x.array() + 1);
    send(as_waypoint(stream.next(), fixed.cast<float>().cast<double>()), fixed);
  }

  /// These allocate themselves.
  template <typename Send>
  void append_temporaries(RecordedRoles& stream, const Send& send) const {
    send(as_waypoint(stream.next(), (x + v * dt).eval()), x + v * dt);
    send(as_waypoint(stream.next(), VectorXd(x + v * dt)), x + v * dt);
  }

  template <typename Send>
  void append_parts(RecordedRoles& stream, const Send& send) const {
    send(as_waypoint(stream.next(), columns.col(1)), columns.col(1));
    send(as_waypoint(stream.next(), wide.row(2)), wide.row(2).transpose());
    send(as_waypoint(stream.next(), rows.row(2)), rows.row(2).transpose());
    send(as_waypoint(stream.next(), wide.col(0).head<3>()), wide.col(0).head<3>());
    send(as_waypoint(stream.next(), wide.row(1) * 2), wide.row(1).transpose() * 2);
    send(as_waypoint(stream.next(), Vector3d::Map(plain.data())), Vector3d(7, 8, 9));
    const Eigen::Ref<const VectorXd> reference(columns.col(2));
    send(as_waypoint(stream.next(), reference), columns.col(2));
    send(as_waypoint(stream.next(), Eigen::Ref<const VectorXd>(columns.col(3))), columns.col(3));
    const Eigen::Map<const VectorXd, 0, Eigen::InnerStride<2>> strided(pairs.data(), 3);
    send(as_waypoint(stream.next(), strided), Vector3d(1, 2, 4));
    send(as_waypoint(stream.next(), plain), Vector3d(7, 8, 9));
    send(Waypoint{.time = stream.next(), .position = columns.col(3)}, columns.col(3));
  }
};

void append_all(RecordedRoles& stream) {
  Forms().append(stream, [&](const Waypoint& waypoint, const VectorXd& /*position*/) {
    EXPECT_EQ(stream.producer.append(waypoint), AppendStatus::accepted);
  });
}

TEST(EigenForms, AWaypointIsAppendedInEachFormWithItsValues) {
  RecordedRoles stream(3);
  const Forms forms;
  std::vector<VectorXd> expected;
  forms.append(stream, [&](const Waypoint& waypoint, const VectorXd& position) {
    EXPECT_EQ(stream.producer.append(waypoint), AppendStatus::accepted) << expected.size();
    EXPECT_TRUE(as_vector(waypoint.position) == position) << expected.size();
    expected.push_back(position);
  });
  Reader& reader = stream.finish();
  EigenState<3> state;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(has_values(reader.sample(static_cast<int>(i + 1) * kPace, state)));
    EXPECT_TRUE(state.position.isApprox(expected[i], 1e-12)) << i;
  }
  EXPECT_EQ(expected.size(), 26U);
}

TEST(EigenForms, AnExpressionIsCopiedAndAVectorIsViewed) {
  const Forms forms;
  const auto viewed = as_waypoint(Time(1), forms.x, forms.columns.col(0));
  static_assert(std::is_same_v<decltype(viewed), const Waypoint>);
  EXPECT_EQ(viewed.velocity.data(), forms.columns.data());
  const auto copied = as_waypoint(Time(1), forms.x, forms.v * 2, forms.a);
  const Waypoint waypoint = copied;
  EXPECT_EQ(waypoint.time, Time(1));
  EXPECT_EQ(waypoint.position.data(), forms.x.data());
  EXPECT_NE(waypoint.velocity.data(), forms.v.data());
  EXPECT_TRUE(as_vector(waypoint.velocity) == forms.v * 2);
  EXPECT_EQ(waypoint.acceleration.data(), forms.a.data());
  const auto moved = copied;  // a copy has its own values
  EXPECT_TRUE(as_vector(Waypoint(moved).velocity) == forms.v * 2);
}

TEST(EigenForms, AnExpressionOfMoreValuesThanAnyStreamHasIsRefused) {
  const VectorXd most = VectorXd::Ones(64), more = VectorXd::Ones(65);
  EXPECT_EQ(Waypoint(as_waypoint(Time(1), 2 * most)).position.size(), 64U);
  try {
    (void)as_waypoint(Time(1), 2 * more);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a vector of 65 values; a stream has at most 64");
  }
}

/// A finished stream of the columns of a matrix, or of rows, that replace a first waypoint.
template <typename Replace>
MatrixXd replaced_positions(const std::vector<Time>& times, const Replace& replace) {
  RecordedRoles stream(3);
  EXPECT_EQ(stream.producer.append(as_waypoint(Time(0), Vector3d(0, 0, 0))),
            AppendStatus::accepted);
  EXPECT_EQ(replace(stream.producer), AppendStatus::accepted);
  EXPECT_EQ(stream.producer.last_item(), 1U);
  Reader& reader = stream.finish();
  MatrixXd positions(3, times.size());
  std::vector<SampleStatus> status(times.size());
  EXPECT_GT(reader.sample_many(times, as_block(positions, status)), 0U);
  for (const SampleStatus one : status) EXPECT_TRUE(has_values(one));
  return positions;
}

/// Some waypoints as columns, and as rows of a row-major matrix.
struct MatrixRecording {
  std::vector<Time> times;
  MatrixXd columns{3, 20};
  RowMajorXd<Eigen::Dynamic, 3> rows;

  MatrixRecording() {
    for (int i = 0; i < 20; ++i) {
      times.push_back((i + 1) * kPace);
      columns.col(i) << std::sin(0.3 * i), 0.1 * i, std::cos(0.2 * i);
    }
    rows = columns.transpose();
  }
  [[nodiscard]] std::vector<Waypoint> list() const {
    std::vector<Waypoint> list;
    for (int i = 0; i < 20; ++i) {
      list.push_back(as_waypoint(times[static_cast<std::size_t>(i)], columns.col(i)));
    }
    return list;
  }
};

TEST(EigenForms, AMatrixReplacesTheMotionAsItsWaypointsDo) {
  const MatrixRecording recording;
  const Time t = kPace / 2;
  const auto with = [&](const auto& replace) {
    return replaced_positions(recording.times, replace);
  };
  const MatrixXd expected = with([&](Producer& p) { return p.replace_from(t, recording.list()); });
  const MatrixXd columns = with([&](Producer& p) {
    return p.replace_from(t, as_waypoints(recording.times, recording.columns));
  });
  const MatrixXd rows = with([&](Producer& p) {
    return p.replace_from(t, as_waypoints(recording.times, recording.rows));
  });
  EXPECT_TRUE(columns == expected);
  EXPECT_TRUE(rows == expected);
  EXPECT_TRUE(expected.col(19) == recording.columns.col(19));
  const MatrixXd soon = with([&](Producer& p) {
    return p.replace_from(as_waypoints(recording.times, recording.columns), {.blend = kPace});
  });
  EXPECT_TRUE(soon.col(19) == recording.columns.col(19));
}

TEST(EigenForms, IncompleteColumnsDoNotReplace) {
  const MatrixRecording recording;
  RecordedRoles stream(3);
  const Waypoints short_one{.dimensions = 3,
                            .times = recording.times,
                            .positions = std::span(recording.columns.data(), 59)};
  EXPECT_EQ(stream.producer.replace_from(Time(1), short_one), AppendStatus::wrong_dimension);
  const MatrixXd narrow = recording.columns.topRows(2);
  EXPECT_EQ(stream.producer.replace_from(Time(1), as_waypoints(recording.times, narrow)),
            AppendStatus::wrong_dimension);
  EXPECT_EQ(stream.producer.replace_from({}), AppendStatus::accepted);
}

TEST(EigenForms, ACurveIsFittedToColumnsAndToRows) {
  const MatrixRecording recording;
  const PiecewisePolynomial columns = fit(as_waypoints(recording.times, recording.columns), {});
  const PiecewisePolynomial rows = fit(as_waypoints(recording.times, recording.rows), {});
  ASSERT_EQ(columns.segments(), 19U);
  for (std::size_t i = 0; i < 19; ++i) {
    EXPECT_TRUE(as_vector(columns.coefficients(i)) == as_vector(rows.coefficients(i)));
  }
  EigenState<3> state;
  columns.evaluate(recording.times[7], state);
  EXPECT_TRUE(state.position == recording.columns.col(7));
  VectorXd velocity(3);
  columns.derivative(recording.times[7], 1, as_span(velocity));
  EXPECT_TRUE(velocity == state.velocity);
}

TEST(EigenForms, AMatrixOfAnotherShapeIsRefusedWithTheShapes) {
  const MatrixRecording recording;
  const MatrixXd rows = recording.rows;  // column-major: 20 x 3
  const auto message = [&](const auto& matrix) -> std::string {
    try {
      (void)as_waypoints(recording.times, matrix);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(rows),
            "a matrix of 20 x 3 values, 20 from column to column; expected 20 contiguous columns "
            "of 20 values, one per time");
  EXPECT_EQ(message(recording.columns.topRows(2)),
            "a matrix of 2 x 20 values, 3 from column to column; expected 20 contiguous columns "
            "of 2 values, one per time");
  EXPECT_EQ(message(recording.columns), "");
}

TEST(EigenForms, AStateIsReadAsVectorsWithTheBitsOfTheSample) {
  RecordedRoles stream(3);
  const Forms forms;
  EXPECT_EQ(stream.producer.start_from(as_instant(Time(1), forms.x, forms.v * 2, forms.a)),
            AppendStatus::accepted);
  append_all(stream);
  Reader& reader = stream.finish();
  const Time t = 7 * kPace / 2;
  State state(3);
  EigenState<> dynamic(3);
  EigenState<3> fixed;
  ASSERT_TRUE(has_values(reader.sample(t, state)));
  ASSERT_TRUE(has_values(reader.sample(t, dynamic)));
  ASSERT_TRUE(has_values(reader.preview(t, fixed)));
  const VectorXd y = state.position();
  Vector3d z = state.velocity();
  EXPECT_TRUE(y == dynamic.position && z == fixed.velocity);
  z = state.jerk();
  EXPECT_TRUE(z == fixed.jerk && dynamic.jerk == z);
  const Eigen::Map<const VectorXd> map = state.acceleration();
  EXPECT_EQ(map.data(), state.acceleration().data());
  const auto norm = [](const Eigen::Ref<const VectorXd>& x) { return x.norm(); };
  EXPECT_EQ(norm(state.position()), y.norm());
  EXPECT_THROW((void)Eigen::Vector2d(state.position()), std::invalid_argument);
  ASSERT_TRUE(has_values(reader.sample(Time(1), fixed)));
  EXPECT_TRUE(fixed.position == forms.x && fixed.velocity == 2 * forms.v);
}

TEST(EigenForms, AStreamStartsFromAnEigenState) {
  EigenState<3> state;
  state.position << 1, 2, 3;
  state.velocity << 0.5, 0, -1;
  state.acceleration << 4, 5, 6;
  const Instant instant = as_instant(Time(5), state);
  EXPECT_EQ(instant.acceleration.data(), state.acceleration.data());
  RecordedRoles stream(3);
  EXPECT_EQ(stream.producer.start_from(as_instant(Time(5), state)), AppendStatus::accepted);
  EXPECT_EQ(stream.producer.append(as_waypoint(stream.next(), state.position)),
            AppendStatus::accepted);
  EigenState<3> begin;
  ASSERT_TRUE(has_values(stream.finish().sample(Time(5), begin)));
  EXPECT_TRUE(begin.position == state.position && begin.velocity == state.velocity);
  const Waypoint waypoint = as_waypoint(Time(6), state);
  EXPECT_EQ(waypoint.velocity.data(), state.velocity.data());
}

TEST(EigenForms, AHorizonIsReadIntoAHorizonAndIntoMatrices) {
  RecordedRoles stream(3);
  append_all(stream);
  Reader& reader = stream.finish();
  EigenHorizon<3> horizon(10);
  horizon.set_times(kPace, kPace / 3);
  ASSERT_GT(reader.sample_many(horizon.times(), horizon), 0U);
  std::array<SampleStatus, 10> status{};
  MatrixXd positions(3, 10);
  RowMajorXd<10, 3> velocities;
  ASSERT_GT(reader.sample_many(horizon.times(), as_block(positions, status)), 0U);
  ASSERT_GT(
      reader.sample_many(horizon.times(), as_block(velocities, status, Derivatives::velocity)), 0U);
  EXPECT_TRUE(positions == horizon.position());
  EXPECT_TRUE(velocities.transpose() == horizon.velocity());
  MatrixXd narrow(3, 9);
  EXPECT_THROW((void)as_block(narrow, status), std::invalid_argument);
}

TEST(EigenForms, ALoopOfAllFormsAllocatesNothing) {
  RecordedRoles stream(3);
  const Forms forms;
  const MatrixRecording recording;
  bool is_accepted = true;
  const auto send = [&](const Waypoint& waypoint, const auto& /*expected*/) {
    is_accepted = is_accepted && stream.producer.append(waypoint) == AppendStatus::accepted;
  };
  forms.append_vectors(stream, send);
  stream.solve();
  std::vector<Time> times(recording.times);
  std::size_t allocated = 0;
  for (int i = 0; i < 20; ++i) {
    const std::size_t before = testing::allocations();
    forms.append_vectors(stream, send);
    forms.append_parts(stream, send);
    const Time begin = stream.next();
    for (Time& time : times) time = stream.next();
    is_accepted = is_accepted &&
                  stream.producer.replace_from(begin, as_waypoints(times, recording.columns)) ==
                      AppendStatus::accepted;
    allocated += testing::allocations() - before;
    stream.solve();
  }
  EXPECT_TRUE(is_accepted);
  EXPECT_EQ(allocated, 0U);
}

}  // namespace
}  // namespace splinecast
