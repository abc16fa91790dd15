#include "support/shared_files.hpp"

#include <cstdlib>

namespace splinecast::testing {

std::filesystem::path shared_file(const std::string& relative) {
  const char* folder = std::getenv("SPLINECAST_SHARED");
  return std::filesystem::path(folder != nullptr ? folder : SPLINECAST_SHARED) / relative;
}

}  // namespace splinecast::testing
