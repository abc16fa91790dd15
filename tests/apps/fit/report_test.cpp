#include "apps/fit/report_page.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/fit/report_table.hpp"
#include "apps/output/stream.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/calculus.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/curves/rotation.hpp"
#include "tests/fixtures/processes/browser.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::data_of;
using testing::Ended;
using testing::run;
using testing::TestFolder;

/// The facts that report_facts.js records about a page in a browser: after opening, with the mouse
/// over a chart, after a drag from 0.4 to 0.6 of the first velocity chart, after a double click.
json facts_of(const TestFolder& folder, const std::string& page,
              const std::string& hash = "draw=all") {
  return testing::facts_of(folder, page, "fit/report_facts.js", hash);
}

/// A report: the waypoints that all its curves share, the curves and the page.
class Recording {
 public:
  Recording(std::vector<Time> times, std::vector<double> positions, std::size_t dimensions)
      : times_(std::move(times)), positions_(std::move(positions)) {
    report_.title = "plan <b>1</b>";
    report_.waypoints = {.dimensions = dimensions, .times = times_, .positions = positions_};
    for (std::size_t d = 0; d < dimensions; ++d) report_.names.push_back(fmt::format("x{}", d));
    report_.units.assign(dimensions, "rad");
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  void add(const std::string& method, double lambda = 0) {
    FitOptions options;
    options.interpolant = {.method = find_method(method), .lambda = lambda};
    report_.curves.push_back({.name = method, .curve = fit(report_.waypoints, options)});
  }

  [[nodiscard]] std::string page(const TestFolder& folder) const {
    Output output(folder.path("report.html"));
    write_report(report_, output);
    output.close();
    return testing::read_file(folder.path("report.html"));
  }

  Report& report() { return report_; }

 private:
  std::vector<Time> times_;
  std::vector<double> positions_;
  Report report_;
};

TEST(Report, StepsOfAQuaternionAreMeasuredAtUnitLength) {
  const testing::Coning coning;
  std::vector<Time> times;
  std::vector<double> positions;
  for (int i = 0; i < 50; ++i) {
    times.emplace_back(10'000'000LL * i);
    const auto q = coning.quaternion(0.01 * i);
    positions.insert(positions.end(), q.begin(), q.end());
  }
  const Waypoints waypoints{.dimensions = 4, .times = times, .positions = positions};
  FitOptions options;
  options.interpolant.method = find_method("pchip");
  const auto curve = fit(waypoints, options);
  const std::vector<Dimension> kinds(4, {.kind = DimensionKind::quaternion});
  const DimensionKinds quaternion{kinds};
  std::array<double, 4> largest{};
  State left(4);
  State right(4);
  for (std::size_t i = 1; i < curve.segments(); ++i) {
    core::evaluate(4, curve.coefficients(i - 1), curve.seconds(i - 1), left.ref());
    core::evaluate(4, curve.coefficients(i), 0, right.ref());
    quaternion.normalise(left.ref());
    quaternion.normalise(right.ref());
    for (std::size_t d = 0; d < 4; ++d) {
      const double step = right.acceleration()[d] - left.acceleration()[d];
      largest[d] = std::max(largest[d], std::abs(step));
    }
  }
  const ReportTable table = table_of(curve, waypoints, kinds);
  for (std::size_t d = 0; d < 4; ++d) {
    EXPECT_GT(largest[d], 0.1);
    EXPECT_EQ(std::abs(table.rows[d * kDerivatives + 2].step.value), largest[d]) << d;
  }
}

TEST(Report, WritesNoSamplesAloneAndDoesNotChangeRequestedOnes) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n3,0\n");
  const Ended alone = run({"fit", file, "--report", folder.path("a.html")});
  ASSERT_EQ(alone.code, 0) << alone.err;
  EXPECT_EQ(alone.out, "");
  const Ended both = run({"fit", file, "--dt", "0.5", "--report", folder.path("b.html")});
  EXPECT_EQ(both.out, run({"fit", file, "--dt", "0.5"}).out);
  EXPECT_EQ(testing::read_file(folder.path("a.html")), testing::read_file(folder.path("b.html")));
}

TEST(Report, LoadsNoExternalResourceAndKeepsTheLicenceOfDygraphs) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n1,1\n3,0\n");
  ASSERT_EQ(run({"fit", file, "--report", folder.path("a.html")}).code, 0);
  const std::string page = testing::read_file(folder.path("a.html"));
  for (const char* load :
       {"<script src", "<img", "src=\"http", "src=\"//", "href=\"http", "href='http", "href=http",
        "href=\"//", "url(", "@import", "sourceMappingURL", "<link"}) {
    EXPECT_EQ(page.find(load), std::string::npos) << load;
  }
  EXPECT_NE(page.find("@license https://github.com/danvk/dygraphs"), std::string::npos);
}

TEST(Report, ShowsNamesAsPlainText) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,</script><b>x</b>,y&amp;\xe4\n5,0,1\n6,1,1\n8,0,1\n");
  ASSERT_EQ(run({"fit", file, "--report", folder.path("a.html")}).code, 0);
  const std::string page = testing::read_file(folder.path("a.html"));
  EXPECT_EQ(data_of(page).at("dimensions")[0].at("name"), "</script><b>x</b>");
  REQUIRE_BROWSER();
  const json facts = facts_of(folder, page);
  ASSERT_EQ(facts.size(), 4U);
  EXPECT_EQ(facts[0].at("foreign"), 0);
  EXPECT_EQ(facts[0].at("sections")[0].at("heading"), "</script><b>x</b>");
  EXPECT_EQ(facts[0].at("sections")[1].at("heading"), "y&amp;\xef\xbf\xbd");
}

TEST(Report, EveryDimensionHasFourChartsWithUnitsWaypointsAndKnots) {
  REQUIRE_BROWSER();
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t_ns,x,y\n7,0,5\n1000000007,1,5\n3000000007,0,5\n");
  ASSERT_EQ(run({"fit", file, "--report", folder.path("a.html")}).code, 0);
  const json facts = facts_of(folder, testing::read_file(folder.path("a.html")));
  ASSERT_EQ(facts.size(), 4U);
  EXPECT_EQ(facts[0].at("summary"), json({"3", "3 s", "1, 2, 2 s", "7 ns", "c2"}));
  ASSERT_EQ(facts[0].at("sections").size(), 2U);
  const std::array<const char*, 4> titles{"position [unit]", "velocity [unit/s]",
                                          "acceleration [unit/s²]", "jerk [unit/s³]"};
  for (const json& section : facts[0]["sections"]) {
    ASSERT_EQ(section.at("charts").size(), 4U);
    for (std::size_t r = 0; r < 4; ++r) {
      const json& chart = section["charts"][r];
      EXPECT_EQ(chart.at("canvases"), 2);
      EXPECT_EQ(chart.at("titles"), json({"time [s]", titles[r]}));
      EXPECT_EQ(chart.at("legend"), json({"c2", r == 0 ? "waypoint" : "knot"}));
      EXPECT_EQ(chart.at("waypoints"), r == 0 ? 3 : 0);
      EXPECT_EQ(chart.at("knots"), r == 0 ? 0 : 3);
      EXPECT_GE(chart.at("ticks").size(), 3U);
      EXPECT_LT(chart.at("times")[0], 0);
      EXPECT_GT(chart.at("times")[1], 3);
    }
  }
}

TEST(Report, OverlaysCurvesAndItsTableHasTheirExactExtremes) {
  REQUIRE_BROWSER();
  const TestFolder folder;
  const auto mesh = testing::random_mesh(4, 30, 2, 3);
  Recording recording(mesh.times, mesh.positions, 2);
  recording.report().units[1] = "";
  recording.add("c2");
  recording.add("akima");
  recording.add("smoothing", 0.1);
  const json facts = facts_of(folder, recording.page(folder));
  ASSERT_EQ(facts.size(), 4U);
  EXPECT_EQ(facts[0].at("heading"), "plan <b>1</b>");
  EXPECT_EQ(facts[0].at("title"), "plan <b>1</b>");
  for (std::size_t d = 0; d < 2; ++d) {
    const json& section = facts[0].at("sections")[d];
    EXPECT_EQ(section.at("charts")[1].at("titles")[1],
              d == 0 ? "velocity [rad/s]" : "velocity [unit/s]");
    EXPECT_EQ(section["charts"][0].at("legend"), json({"c2", "akima", "smoothing", "waypoint"}));
    ASSERT_EQ(section.at("table").size(), 12U);
    for (std::size_t i = 0; i < 12; ++i) {
      const auto& curve = recording.report().curves[i / 4].curve;
      const auto exact = extremes(curve, d, static_cast<int>(i % 4));
      const json& values = section["table"][i].at("values");
      EXPECT_EQ(values.at(0), exact.least.value);
      EXPECT_EQ(values.at(1), exact.greatest.value);
      const auto range = section["charts"][i % 4].at("range").get<std::array<double, 2>>();
      EXPECT_LT(range[0], exact.least.value);
      EXPECT_GT(range[1], exact.greatest.value);
    }
    EXPECT_EQ(section["table"][0].at("texts").at(6), "≈ 0");  // C2: no steps
    EXPECT_EQ(section["table"][0]["texts"].at(8), "≈ 0");     // C2 interpolates the waypoints
    EXPECT_GT(section["table"][8].at("values").at(3), 1e-3);  // smoothing does not
  }
}

TEST(Report, TheTableOfATwoPiecePolynomialMatchesOneComputedByHand) {
  REQUIRE_BROWSER();
  const TestFolder folder;
  Recording recording({Time(0), Time(1'000'000'000), Time(2'000'000'000)}, {0, 1, 0}, 1);
  PiecewisePolynomial curve(1);
  curve.append(Time(0), Time(1'000'000'000), 4, std::vector<double>{0, 2, -1, 0});
  curve.append(Time(1'000'000'000), Time(2'000'000'000), 4, std::vector<double>{1, 0, 0, -1});
  recording.report().curves.push_back({.name = "by hand", .curve = curve});
  const json facts = facts_of(folder, recording.page(folder));
  ASSERT_EQ(facts.size(), 4U);
  const json& table = facts[0].at("sections")[0].at("table");
  const std::string axis = "acceleration [rad/s²]";
  EXPECT_EQ(table[0].at("texts"),
            json({"by hand", "position [rad]", "0", "0", "1", "1", "≈ 0", ""}));
  EXPECT_EQ(table[1].at("texts"), json({"velocity [rad/s]", "-3", "2", "2", "0", "≈ 0", ""}));
  EXPECT_EQ(table[2].at("texts"), json({axis, "-6", "2", "0", "1", "2", "1"}));
  EXPECT_EQ(table[3].at("texts"), json({"jerk [rad/s³]", "-6", "1", "0", "0", "-6", "1"}));
}

TEST(Report, DrawsBothValuesOfAJumpAtOneTime) {
  const TestFolder folder;
  Recording recording({Time(0), Time(1'000'000'000), Time(2'000'000'000)}, {0, 1, 4}, 1);
  recording.add("c2");
  const json data = data_of(recording.page(folder));
  const auto seconds = data.at("seconds").get<std::vector<double>>();
  const auto knot = std::ranges::equal_range(seconds, 1.0);
  ASSERT_EQ(knot.size(), 2U);
  const auto row = static_cast<std::size_t>(knot.begin() - seconds.begin());
  const json& jerk = data.at("dimensions")[0].at("curves")[0].at("values")[3];
  EXPECT_NEAR(jerk[row].get<double>(), 3, 1e-6);
  EXPECT_NEAR(jerk[row + 1].get<double>(), -3, 1e-6);
}

TEST(Report, KeepsThePeaksOfALongRecordingInASmallFile) {
  const TestFolder folder;
  std::vector<Time> times;
  std::vector<double> positions;
  for (int i = 0; i < 20'000; ++i) {
    times.emplace_back(i * 1'000'000LL);
    positions.push_back(i == 12'345 ? 1 : 1e-3 * std::sin(0.01 * i));
  }
  Recording recording(times, positions, 1);
  recording.add("c2");
  const std::string page = recording.page(folder);
  EXPECT_LT(page.size(), 600'000U);
  const json data = data_of(page);
  EXPECT_EQ(data.at("stride"), 5);
  EXPECT_LE(data.at("seconds").size(), 4000U);
  for (int r = 0; r < 4; ++r) {
    const auto exact = extremes(recording.report().curves[0].curve, 0, r);
    const json& drawn =
        data.at("dimensions")[0].at("curves")[0].at("values")[static_cast<std::size_t>(r)];
    const double tolerance = 1e-6 * (exact.greatest.value - exact.least.value);
    EXPECT_NEAR(*std::ranges::max_element(drawn), exact.greatest.value, tolerance);
    EXPECT_NEAR(*std::ranges::min_element(drawn), exact.least.value, tolerance);
  }
  REQUIRE_BROWSER();
  const json facts = facts_of(folder, page);
  ASSERT_EQ(facts.size(), 4U);
  ASSERT_EQ(facts[0].at("notes").size(), 3U);
  EXPECT_NE(facts[0]["notes"][0].get<std::string>().find("least and greatest"), std::string::npos);
  EXPECT_EQ(facts[0].at("sections")[0].at("coarse"), false);
  const json close = facts_of(folder, page, "draw=all&time=12.3,12.4");
  ASSERT_EQ(close.size(), 4U);
  EXPECT_EQ(close[0].at("sections")[0].at("charts")[0].at("times"), json({12.3, 12.4}));
  EXPECT_EQ(close[0]["sections"][0].at("coarse"), true);
}

TEST(Report, DraggingZoomsTheChartsOfADimensionAndADoubleClickShowsAllAgain) {
  REQUIRE_BROWSER();
  const TestFolder folder;
  const auto mesh = testing::random_mesh(5, 40, 2, 3);
  Recording recording(mesh.times, mesh.positions, 2);
  recording.add("c2");
  const json facts = facts_of(folder, recording.page(folder));
  ASSERT_EQ(facts.size(), 4U);
  const auto charts = [&](std::size_t when, std::size_t d) -> const json& {
    return facts[when].at("sections")[d].at("charts");
  };
  const auto width = [](const json& times) {
    return times.at(1).get<double>() - times.at(0).get<double>();
  };
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_NE(charts(1, 0)[r].at("values")[0], "");  // the legend shows values in all four charts
    EXPECT_EQ(charts(2, 0)[r].at("times"), charts(2, 0)[0].at("times"));
    EXPECT_LT(width(charts(2, 0)[r]["times"]), 0.3 * width(charts(0, 0)[r].at("times")));
    EXPECT_EQ(charts(2, 1)[r].at("times"), charts(0, 1)[r].at("times"));
    EXPECT_EQ(charts(3, 0)[r].at("times"), charts(0, 0)[r].at("times"));
    EXPECT_EQ(charts(3, 0)[r].at("range"), charts(0, 0)[r].at("range"));
  }
  EXPECT_LT(charts(2, 0)[0].at("waypoints"), charts(0, 0)[0].at("waypoints"));
}

TEST(Report, OverlaysSeveralMethodsAndTakesUnitsFromTheColumnsNames) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,q1 [rad],z (m),w[2]\n0,0,1,5\n1,1,2,4\n2,3,1,5\n");
  const Ended ended =
      run({"fit", file, "--method", "c2,pchip,akima", "--report", folder.path("a.html")});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string page = testing::read_file(folder.path("a.html"));
  const json data = data_of(page);
  EXPECT_EQ(data.at("dimensions")[0].at("name"), "q1");
  EXPECT_EQ(data.at("dimensions")[0].at("unit"), "rad");
  EXPECT_EQ(data.at("dimensions")[1].at("unit"), "m");
  EXPECT_EQ(data.at("dimensions")[2].at("name"), "w[2]");
  const Ended reported = run({"fit", file, "--unit", "deg", "--method", "c2", "--method", "pchip",
                              "--report", folder.path("b.html")});
  ASSERT_EQ(reported.code, 0) << reported.err;
  EXPECT_EQ(data_of(testing::read_file(folder.path("b.html"))).at("dimensions")[2].at("unit"),
            "deg");
  EXPECT_EQ(run({"fit", file, "--unit", "deg", "--dt", "1"}).code, 2);
  REQUIRE_BROWSER();
  const json facts = facts_of(folder, page);
  ASSERT_EQ(facts.size(), 4U);
  const std::string chart = facts[0].at("sections")[0].at("charts")[1].dump();
  for (const char* method : {"c2", "pchip", "akima"}) {
    EXPECT_NE(chart.find(method), std::string::npos) << chart;
  }
  EXPECT_NE(chart.find("rad/s"), std::string::npos) << chart;
}

TEST(Report, OneWaypointIsAPointInEachChart) {
  REQUIRE_BROWSER();
  const TestFolder folder;
  const auto file = folder.write("one.csv", "t_ns,x\n5,7\n");
  ASSERT_EQ(run({"fit", file, "--report", folder.path("a.html")}).code, 0);
  const json facts = facts_of(folder, testing::read_file(folder.path("a.html")));
  ASSERT_EQ(facts.size(), 4U);
  const json& section = facts[0].at("sections").at(0);
  EXPECT_EQ(section.at("charts")[0].at("waypoints"), 1);
  const auto range = section["charts"][0].at("range").get<std::array<double, 2>>();
  EXPECT_LT(range[0], 7);
  EXPECT_GT(range[1], 7);
  EXPECT_EQ(section.at("table")[0].at("values"), json({7.0, 7.0, 0.0}));
  EXPECT_EQ(facts[0].at("notes")[0], "A single waypoint: the curve holds its position.");
}

}  // namespace
}  // namespace splinecast::apps
