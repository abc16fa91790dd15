#pragma once

#include <filesystem>
#include <string>

namespace splinecast::testing {

/// A file of the shared folder beside the project (or in $SPLINECAST_SHARED). It may be missing:
/// the tests that need it then skip by name.
std::filesystem::path shared_file(const std::string& relative);

}  // namespace splinecast::testing

/// Skips the test by the missing file's name unless the file is there.
#define REQUIRE_SHARED_FILE(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "not on this machine: " << (path)
