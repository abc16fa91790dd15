#include "apps/limits/file.hpp"

#include <fmt/format.h>

#include "apps/files/text_file.hpp"
#include "apps/process/exit_codes.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

LimitFile read_limit_file(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{16} << 20U;
  const TextFile file(path);
  if (file.text().size() > kMostBytes) {
    throw InputError(
        fmt::format("{}: {} bytes are too many for a file of limits; the maximum is {}",
                    file.name(), file.text().size(), kMostBytes));
  }
  const std::string text(file.text());
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string::npos) throw InputError(file.name() + ": the file is empty");
  return text[first] == '<' ? read_urdf(file.name(), text)
                            : read_joint_limits_yaml(file.name(), text);
}

double limit_value(const std::string& where, std::string_view what, double value) {
  if (is_usable(value) && value >= 0) return value;
  throw InputError(fmt::format("{}: {} {} is not a number from 0 to 1e100", where, what, value));
}

}  // namespace splinecast::apps
