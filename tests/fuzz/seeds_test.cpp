#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "ipc/board/knot.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/table.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fuzz/region_targets.hpp"
#include "tests/fuzz/seed_streams.hpp"
#include "tests/fuzz/text_targets.hpp"

/// The fuzzers' targets in every build, with inputs that fuzzers have found and with mutations of
/// whole streams.
namespace splinecast::fuzz {
namespace {

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> paths;
  const std::string seeds = std::string(SPLINECAST_SOURCE) + "/tests/fuzz/seeds/" + folder;
  for (const auto& entry : std::filesystem::directory_iterator(seeds)) {
    paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

StreamImage image_in(const std::string& path) {
  const std::string text = testing::read_file(path);
  return decode(std::vector<std::uint8_t>(text.begin(), text.end()));
}

void try_texts(const std::string& folder, void (*target)(std::string_view)) {
  const auto paths = files_in(folder);
  EXPECT_FALSE(paths.empty());
  for (const std::string& path : paths) {
    EXPECT_NO_THROW(target(testing::read_file(path))) << path;
  }
}

TEST(FuzzSeeds, RegionsAreReadRefusedOrContinued) {
  const auto paths = files_in("regions");
  EXPECT_FALSE(paths.empty());
  for (const std::string& path : paths) EXPECT_NO_THROW(try_all(image_in(path))) << path;
}

TEST(FuzzSeeds, MutatedStreamsAreReadRefusedOrContinued) {
  for (const Seed& seed : make_seeds()) {
    // The board of a law has 2 MiB, of which each target makes copies.
    const std::uint64_t mutations = seed.image.commander.empty() ? 400 : 60;
    for (std::uint64_t i = 0; i < mutations; ++i) {
      std::mt19937_64 random(i);
      StreamImage image = seed.image;
      mutate(image, random);
      EXPECT_NO_THROW(try_reader(image)) << seed.name << ", mutation " << i;
      EXPECT_NO_THROW(try_writers(image)) << seed.name << ", mutation " << i;
      if (i % 10 == 0) {
        EXPECT_NO_THROW(try_roles(image)) << seed.name << ", mutation " << i;
      }
    }
  }
}

TEST(FuzzSeeds, HaveUndamagedSegmentsOfEveryForm) {
  std::set<core::SegmentForm> forms;
  for (const Seed& seed : make_seeds()) {
    const auto region = std::as_bytes(std::span(seed.image.board));
    const auto layout = ipc::checked_board_layout(ipc::copy_header(region), region.size());
    const ipc::KnotBoardReader board(region, layout);
    ipc::Summary summary;
    if (!board.copy_summary(board.look(), summary)) continue;
    ipc::KnotCopy knot(board.dimensions(), board.smooths());
    ipc::BoardSegment segment(board.dimensions(), board.smooths());
    for (ipc::Word number = summary.first; number > 0 && number <= summary.newest; ++number) {
      ASSERT_TRUE(board.copy_knot(number, summary.revision, knot)) << seed.name << ' ' << number;
      forms.insert(knot.note.form);
      EXPECT_NE(segment.take(board, summary, number), ipc::BoardSegment::Taken::torn)
          << seed.name << ' ' << number;
    }
  }
  EXPECT_EQ(forms.size(), static_cast<std::size_t>(core::kSegmentForms));
}

TEST(FuzzSeeds, AnEncodedImageDecodesToTheSameImage) {
  for (const Seed& seed : make_seeds()) {
    const StreamImage again = decode(encode(seed.image));
    EXPECT_EQ(again.ring, seed.image.ring);
    EXPECT_EQ(again.board, seed.image.board);
    EXPECT_EQ(again.commander, seed.image.commander);
    EXPECT_EQ(again.script, seed.image.script);
  }
}

TEST(FuzzSeeds, WaypointFilesAreReadOrRefused) { try_texts("waypoints", try_waypoints); }
TEST(FuzzSeeds, MessagesOfTopicsAreReadOrRefused) { try_texts("topics", try_topics); }
TEST(FuzzSeeds, TimeFilesAreReadOrRefused) { try_texts("times", try_times); }
TEST(FuzzSeeds, PolynomialFilesAreReadOrRefused) { try_texts("polynomials", try_polynomials); }
TEST(FuzzSeeds, LimitFilesAreReadOrRefused) { try_texts("limits", try_limits); }
TEST(FuzzSeeds, RecordingsAreReadRecoveredOrRefused) {
  REQUIRE_MCAP();
  try_texts("recordings", try_recordings);
}
TEST(FuzzSeeds, WordsAreReadOrRefused) { try_texts("words", try_words); }
TEST(FuzzSeeds, CommandLinesAreReadOrRefused) { try_texts("arguments", try_arguments); }

TEST(ByteFlip, NoProcessCrashesHangsOrReturnsANonFiniteValue) {
  const testing::Ended ended =
      testing::Process(SPLINECAST_BYTEFLIP, {"--seconds", "3", "--seed", "7"}).wait();
  EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
  const auto report = nlohmann::json::parse(ended.out, nullptr, false);
  ASSERT_FALSE(report.is_discarded());
  EXPECT_GT(report["count"], 0);
  EXPECT_GT(report["measured"]["samples with values"], 0);
}

}  // namespace
}  // namespace splinecast::fuzz
