#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/layout/header.hpp"
#include "tests/apps/streams/forbidden.hpp"

/// Invalid or untrusted files at the paths of a stream.
namespace splinecast::apps {
namespace {

using testing::Confinement;
using testing::PrivateSharedMemory;
using Path = std::filesystem::path;

constexpr const char* kRing = "splinecast.a.waypoints";
constexpr const char* kBoard = "splinecast.a.spline";
/// Possible owners of a file: the user that runs the verbs, or another user.
constexpr uid_t kUser = 65534;
constexpr uid_t kStranger = 12345;

/// A change that makes the file at a path invalid or untrusted.
struct Obstacle {
  std::function<void(const Path&)> put;
  std::vector<std::string> said{};  ///< in the error, in addition to the path
  bool is_own_litter = false;       ///< a private regular file of the user: `rm` removes it
};

void patch(const Path& path, std::size_t offset, std::uint32_t value) {
  const int file = open(path.c_str(), O_WRONLY);
  ASSERT_EQ(pwrite(file, &value, sizeof value, static_cast<off_t>(offset)),
            static_cast<ssize_t>(sizeof value));
  close(file);
}

/// Changes the owner of a new file to the user that runs the verbs.
void give(const Path& path) {
  if (geteuid() != 0) return;
  ASSERT_EQ(lchown(path.c_str(), kUser, kUser), 0);
}

Obstacle patched(std::size_t offset, std::uint32_t value, std::vector<std::string> said) {
  return {.put = [=](const Path& path) { patch(path, offset, value); },
          .said = std::move(said),
          .is_own_litter = true};
}

Obstacle sized(off_t bytes, std::vector<std::string> said) {
  return {.put = [=](const Path& path) { ASSERT_EQ(truncate(path.c_str(), bytes), 0); },
          .said = std::move(said),
          .is_own_litter = true};
}

Obstacle with_mode(mode_t mode, std::vector<std::string> said) {
  return {.put = [=](const Path& path) { ASSERT_EQ(chmod(path.c_str(), mode), 0); },
          .said = std::move(said)};
}

Obstacle instead(const std::function<int(const Path&)>& make) {
  return {.put =
              [=](const Path& path) {
                std::filesystem::remove(path);
                ASSERT_EQ(make(path), 0);
                give(path);
              },
          .said = {"is not a regular file"}};
}

consteval std::size_t header_offset(std::string_view field) {
  return ipc::word_of(ipc::kHeaderFields, field) * sizeof(ipc::Word);
}
constexpr std::size_t kMark = header_offset("layout version, byte order");
const std::string kVersion = std::to_string(ipc::kLayoutVersion);

const std::vector<Obstacle>& obstacles() {
  static const std::vector<Obstacle> all{
      sized(0, {"has 0 bytes"}),
      sized(100, {"has 100 bytes"}),
      sized(16384, {"size 16384"}),
      sized(64 << 20, {"size 67108864"}),
      patched(0, 7, {"magic number"}),
      patched(kMark, 9,
              {"layout version 9", "this splinecast has version " + kVersion, "`splinecast rm`"}),
      patched(header_offset("layout hash"), 7,
              {"layout version " + kVersion + " with hash",
               "this splinecast has version " + kVersion + " with hash " +
                   std::to_string(ipc::layout_hash()),
               "`splinecast rm`"}),
      patched(kMark + sizeof(std::uint32_t), 0x04030201, {"byte order 67305985"}),
      patched(header_offset("dimensions"), 65, {"dimensions 65"}),
      with_mode(0660, {"may be written by others", "0660"}),
      with_mode(0602, {"may be written by others", "0602"}),
      instead([](const Path& path) { return mkfifo(path.c_str(), 0600); }),
      instead([](const Path& path) { return mkdir(path.c_str(), 0700); }),
      instead([](const Path& path) { return symlink("/etc/passwd", path.c_str()); }),
      instead([](const Path& path) { return symlink("splinecast.b.spline", path.c_str()); })};
  return all;
}

class ForbiddenFiles : public Forbidden {
 protected:
  /// Makes a finished stream of the user and turns one of its files into an obstacle.
  void with_obstacle(const char* file, const Obstacle& obstacle,
                     const std::function<void(const PrivateSharedMemory&)>& then) {
    const PrivateSharedMemory memory("128m");
    const testing::Ended made = memory.run(replay({"--embedded"}), {});
    ASSERT_EQ(made.code, 0) << made.err;
    obstacle.put(memory.file(file));
    then(memory);
  }

  void expect_refused_under_the_board(bool own_litter) {
    for (const Obstacle& obstacle : obstacles()) {
      if (obstacle.is_own_litter != own_litter) continue;
      auto said = obstacle.said;
      said.emplace_back(kBoard);
      with_obstacle(kBoard, obstacle, [&](const PrivateSharedMemory& memory) {
        attack_without_effect(memory, {"solve", "a"}, 1, said);
        attack_without_effect(memory, replay(), 1, said);
        attack_without_effect(memory, replay({"--embedded"}), 1, said);
        attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 1, said);
        attack_without_effect(memory, {"info", "a"}, 1, said);
        attack_without_effect(memory, {"ls"}, 0, said);
        if (!obstacle.is_own_litter) attack_without_effect(memory, {"rm", "a"}, 1, said);
      });
    }
  }

  void expect_refused_under_the_ring(bool own_litter) {
    for (const Obstacle& obstacle : obstacles()) {
      if (obstacle.is_own_litter != own_litter) continue;
      auto said = obstacle.said;
      said.emplace_back(kRing);
      with_obstacle(kRing, obstacle, [&](const PrivateSharedMemory& memory) {
        attack_without_effect(memory, {"solve", "a"}, 1, said);
        attack_without_effect(memory, replay(), 4, {"no solver for stream 'a'"});
        attack_without_effect(memory, replay({"--embedded"}), 1, said);
        // The curve remains readable: readers need no producer.
        attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0,
                              {"settled"});
        attack_without_effect(memory, {"info", "a"}, 1, said);
        attack_without_effect(memory, {"ls"}, 0, said);
        if (!obstacle.is_own_litter) attack_without_effect(memory, {"rm", "a"}, 1, said);
      });
    }
  }
};

TEST_F(ForbiddenFiles, InvalidAsABoardAreRefusedByEachVerbAndUnchanged) {
  expect_refused_under_the_board(true);
}

TEST_F(ForbiddenFiles, UntrustedAsABoardAreRefusedByEachVerbAndUnchanged) {
  expect_refused_under_the_board(false);
}

TEST_F(ForbiddenFiles, InvalidAsARingAreRefusedByEachVerbAndUnchanged) {
  expect_refused_under_the_ring(true);
}

TEST_F(ForbiddenFiles, UntrustedAsARingAreRefusedByEachVerbAndUnchanged) {
  expect_refused_under_the_ring(false);
}

TEST_F(ForbiddenFiles, WithoutOtherFilesAreRefusedAndNoFileIsCreated) {
  for (const Obstacle& obstacle : obstacles()) {
    if (obstacle.is_own_litter) continue;
    auto said = obstacle.said;
    said.emplace_back(kBoard);
    with_obstacle(kBoard, obstacle, [&](const PrivateSharedMemory& memory) {
      for (const char* const other :
           {kRing, "splinecast.a.waypoints.lock", "splinecast.a.spline.lock"}) {
        std::filesystem::remove(memory.file(other));
      }
      attack_without_effect(memory, {"solve", "a"}, 1, said);
      attack_without_effect(memory, replay(), 1, said);
      attack_without_effect(memory, replay({"--embedded"}), 1, said);
      attack_without_effect(memory, {"rm", "a"}, 1, said);
    });
  }
}

TEST_F(ForbiddenFiles, OfTheUserThatAreInvalidRegionsAreRemovedByRm) {
  for (const Obstacle& obstacle : obstacles()) {
    if (!obstacle.is_own_litter) continue;
    with_obstacle(kBoard, obstacle, [&](const PrivateSharedMemory& memory) {
      attack(memory, {"rm", "a"}, 0, {});
      EXPECT_TRUE(memory.listing().empty());
    });
  }
}

TEST_F(ForbiddenFiles, OfAnotherUserAreRefusedWithTheOwnerAndUnchanged) {
  REQUIRE_ROOT();
  for (const mode_t mode : {0600U, 0644U}) {
    for (const char* const file : {kBoard, kRing}) {
      const Obstacle strangers{.put = [=](const Path& path) {
        ASSERT_EQ(chown(path.c_str(), kStranger, kStranger), 0);
        ASSERT_EQ(chmod(path.c_str(), mode), 0);
      }};
      // The owner of a file that may not be opened is unknown.
      const std::vector<std::string> said{
          file, mode == 0600U ? "Permission denied" : "belongs to user 12345"};
      // A writer opens the file for writing, which the kernel refuses before the owner is checked.
      const std::vector<std::string> to_writers{file};
      with_obstacle(file, strangers, [&](const PrivateSharedMemory& memory) {
        attack_without_effect(memory, {"solve", "a"}, 1, to_writers);
        attack_without_effect(memory, replay({"--embedded"}), 1, to_writers);
        attack_without_effect(memory, {"info", "a"}, 1, said);
        attack_without_effect(memory, {"ls"}, 0, said);
        attack_without_effect(memory, {"rm", "a"}, 1, said);
        // No partial removal: a failure at the board must not remove the ring.
        EXPECT_EQ(memory.listing().size(), 4U);
      });
    }
  }
}

TEST_F(ForbiddenFiles, InvalidAsALockStopWritersWithTheirPath) {
  const std::vector<Obstacle> locks{
      with_mode(0644, {"is not a private file", "0644"}),
      instead([](const Path& path) { return mkdir(path.c_str(), 0700); }),
      instead([](const Path& path) { return symlink("/etc/passwd", path.c_str()); }),
      instead([](const Path& path) { return mkfifo(path.c_str(), 0600); })};
  for (const Obstacle& obstacle : locks) {
    const std::string lock = "splinecast.a.spline.lock";
    with_obstacle(lock.c_str(), obstacle, [&](const PrivateSharedMemory& memory) {
      attack_without_effect(memory, {"solve", "a"}, 1, {lock});
      attack_without_effect(memory, replay({"--embedded"}), 1, {lock});
      attack_without_effect(memory, {"rm", "a"}, 1, {lock});
      attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0,
                            {"settled"});
      attack_without_effect(memory, {"info", "a"}, 0, {"finished"});
    });
  }
}

TEST_F(ForbiddenFiles, ALockOfAnotherUserStopsWritersWithItsPath) {
  REQUIRE_ROOT();
  const std::string lock = "splinecast.a.spline.lock";
  const Obstacle strangers{
      .put = [](const Path& path) { ASSERT_EQ(chown(path.c_str(), kStranger, kStranger), 0); }};
  with_obstacle(lock.c_str(), strangers, [&](const PrivateSharedMemory& memory) {
    attack_without_effect(memory, {"solve", "a"}, 1, {lock, "belongs to another user"});
    attack_without_effect(memory, {"rm", "a"}, 1, {lock, "belongs to another user"});
    attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0, {"settled"});
  });
}

TEST_F(ForbiddenFiles, WithInvalidStreamNamesEndNoVerbAndAreNotPrinted) {
  const PrivateSharedMemory memory("8m");
  const int before = memory.run({"doctor"}, {}).code;
  for (const char* const name : {"splinecast.a bad.waypoints", "splinecast.a\033[2J\n.spline",
                                 "splinecast..a.waypoints", "splinecast.\xff.spline.lock"}) {
    const int file = open(memory.file(name).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    ASSERT_GE(file, 0);
    close(file);
  }
  attack_without_effect(memory, {"ls"}, 0, {"STREAM"});
  attack_without_effect(memory, {"ls", "--json"}, 0, {"[]"});
  const auto doctor = attack_without_effect(memory, {"doctor"}, before, {"ok"});
  EXPECT_EQ(doctor.out.find('\033'), std::string::npos) << doctor.out;
  attack_without_effect(memory, {"info", "a\033[2J"}, 2, {R"('a\x1b[2J' cannot name a stream)"});
  attack_without_effect(memory, {"fit", "no\033[2J\nfile.csv", "--dt", "0.1"}, 2,
                        {R"(no\x1b[2J\x0afile.csv: no such)"});
}

}  // namespace
}  // namespace splinecast::apps
