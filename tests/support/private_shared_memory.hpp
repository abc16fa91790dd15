#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/process.hpp"

namespace splinecast::testing {

/// Who runs a program, and with what.
struct Confinement {
  uid_t user = 65534;
  gid_t group = 65534;
  std::vector<gid_t> groups{};         ///< supplementary ones
  std::vector<std::string> limits{};   ///< as `prlimit` takes them: `--nofile=4`
  std::vector<std::string> wrapper{};  ///< a program, and its arguments, that runs the rest
};

/// Shared memory of a test's own: a mount namespace with a small tmpfs on /dev/shm, so that a test
/// may fill it, and knows each file in it. Goes with this object. Root acts as any user in it;
/// another user, whose namespace it is, as its root only.
class PrivateSharedMemory {
 public:
  /// Whether this machine lets this user have one.
  static bool is_allowed();

  /// `size` as tmpfs takes it: `64m`.
  explicit PrivateSharedMemory(const std::string& size);

  /// Path of its /dev/shm, as this process sees it.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

  /// Starts a program in it by its path, or `splinecast`.
  [[nodiscard]] Process start(const std::string& program, const std::vector<std::string>& arguments,
                              const Confinement& who) const;
  [[nodiscard]] Process start(const std::vector<std::string>& arguments,
                              const Confinement& who) const;
  /// Runs `splinecast` in it to its end.
  [[nodiscard]] Ended run(const std::vector<std::string>& arguments, const Confinement& who) const;

  /// Each file by name: its type, mode, owner, group, size and a hash of its bytes or its target.
  [[nodiscard]] std::map<std::string, std::string> listing() const;

 private:
  Process holder_;
  std::filesystem::path folder_;
};

}  // namespace splinecast::testing

/// Skips the test by what is missing.
#define REQUIRE_PRIVATE_SHARED_MEMORY()                        \
  if (!splinecast::testing::PrivateSharedMemory::is_allowed()) \
  GTEST_SKIP() << "needs a mount namespace of its own (root, or user namespaces)"
#define REQUIRE_ROOT() \
  if (geteuid() != 0) GTEST_SKIP() << "needs root, which can act as several users"
