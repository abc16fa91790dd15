#include "apps/record/output/files.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "ipc/options/stream.hpp"
#include "tests/apps/record/recorded.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// The files of a recorder in this process, with a bound of their size as the full disk.
namespace splinecast::apps::record {
namespace {

class RecordFiles : public testing::RecorderTest {};

constexpr ipc::Word kItems = 60;
constexpr std::size_t kDimensions = 3;

Record options() {
  StreamOptions options{.stream = "arm"};
  options.waypoints =
      ipc::make_header({.dimensions = kDimensions, .clock = StreamClock::recorded}, 77);
  options.waypoints.capacity = 64;
  Record record{.kind = RecordKind::options, .number = 77};
  record.bytes = {static_cast<std::byte>(RecordKind::options)};
  ByteWriter(record.bytes).put(std::string_view(to_json(options).dump()));
  return record;
}

Record item(ipc::Word number) {
  ipc::RingItem item(kDimensions);
  item.time = Time(10'000'000) * static_cast<std::int64_t>(number);
  item.values[0] = 1.0 / static_cast<double>(number + 1);
  return {.kind = RecordKind::item,
          .number = number,
          .next = number + 1,
          .bytes = encode({.number = number, .item = item})};
}

/// No file of this process can become larger, as long as this exists.
class FileBound {
 public:
  explicit FileBound(std::uint64_t bytes) : signal_(::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit bound{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &bound);
  }
  ~FileBound() {
    setrlimit(RLIMIT_FSIZE, &before_);
    (void)::signal(SIGXFSZ, signal_);
  }
  FileBound(const FileBound&) = delete;
  FileBound& operator=(const FileBound&) = delete;

 private:
  rlimit before_{};
  sighandler_t signal_;
};

/// Records items in three chunks. Returns what the recorder says of it. If the folder is moved, no
/// other file can follow at the end.
OutputReport record_items(const std::string& folder, const std::string& moved = {}) {
  Files files({.path = folder + "/run.mcap", .file = {.compression = mcap::Compression::none}});
  Time now(1);
  for (ipc::Word number = 0; number < kItems; ++number) {
    Batch batch{.now = now};
    if (number == 0) batch.add(options());
    batch.add(item(number));
    files.take(std::move(batch));
    if (number % 20 == 19 && number + 1 < kItems) files.tick(now += Time(800'000'000));
  }
  if (!moved.empty()) std::filesystem::rename(folder, moved);
  files.finish(now);
  return files.report();
}

/// The numbers of the items in all files of a folder: each must be from 0 without a gap.
std::size_t items_in(const std::string& folder) {
  std::size_t most = 0;
  for (const std::string& path : testing::recordings_in(folder)) {
    const auto messages = testing::messages_of(path, "/arm/waypoints");
    for (std::size_t n = 0; n < messages.size(); ++n) EXPECT_EQ(messages[n]["item"], n) << path;
    most = std::max(most, messages.size());
  }
  return most;
}

/// The disk is full at any byte, of a chunk or of the summary of the file: what the report counts
/// as recorded is what the files have, and the rest is lost.
TEST_F(RecordFiles, OnADiskThatIsFullAtAnyByteTheReportSaysWhatTheFilesHave) {
  const testing::TestFolder folder;
  const std::string place = folder.path("place");
  const std::string moved = folder.path("moved");
  std::filesystem::create_directory(place);
  const OutputReport whole = record_items(place, moved);
  ASSERT_EQ(whole.account.items.recorded, kItems);
  ASSERT_EQ(items_in(moved), kItems);
  std::map<std::size_t, std::size_t> runs;  // by the number of items that are in the files
  for (std::uint64_t bytes = 60; bytes < whole.bytes; bytes += 97) {
    std::filesystem::remove_all(moved);
    std::filesystem::create_directory(place);
    const OutputReport report = [&] {
      const FileBound bound(bytes);
      return record_items(place, moved);
    }();
    const std::size_t found = items_in(moved);
    ASSERT_EQ(report.account.items.recorded, found) << bytes << " of " << whole.bytes << " bytes";
    ASSERT_EQ(report.account.all_lost().items, kItems - found) << bytes;
    ++runs[found];
  }
  EXPECT_GT(runs[kItems], 10U) << "full in the summary";
  EXPECT_GT(runs[40], 10U) << "full in the last chunk";
}

}  // namespace
}  // namespace splinecast::apps::record
