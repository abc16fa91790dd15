#include "support/recordings.hpp"

#include <fmt/format.h>

#include <iterator>
#include <sstream>

namespace splinecast::testing {

std::string to_csv(const Mesh& mesh) {
  std::string text = "t_ns";
  auto to = std::back_inserter(text);
  for (std::size_t d = 0; d < mesh.dimensions; ++d) fmt::format_to(to, ",x{}", d);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    fmt::format_to(to, "\n{}", mesh.times[i].count());
    for (const double x : mesh.position(i)) fmt::format_to(to, ",{}", x);
  }
  return text + "\n";
}

std::string times_csv(const Mesh& mesh, std::size_t per_interval) {
  std::string text = "t_ns\n";
  for (const core::Time t : query_times(mesh, per_interval)) {
    fmt::format_to(std::back_inserter(text), "{}\n", t.count());
  }
  return text;
}

std::string without_status(const std::string& samples) {
  std::istringstream lines(samples);
  std::string text;
  for (std::string line; std::getline(lines, line);) text += line.substr(0, line.rfind(',')) + "\n";
  return text;
}

std::size_t count_status(const std::string& samples, const std::string& status) {
  std::istringstream lines(samples);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with("," + status)) ++count;
  }
  return count;
}

::testing::AssertionResult same_text(const std::string& got, const std::string& wanted) {
  if (got == wanted) return ::testing::AssertionSuccess();
  std::istringstream got_lines(got);
  std::istringstream wanted_lines(wanted);
  std::string a;
  std::string b;
  for (std::size_t line = 1;; ++line) {
    const bool has_a = static_cast<bool>(std::getline(got_lines, a));
    const bool has_b = static_cast<bool>(std::getline(wanted_lines, b));
    if (has_a && has_b && a == b) continue;
    return ::testing::AssertionFailure() << "line " << line << " is '" << (has_a ? a : "missing")
                                         << "', not '" << (has_b ? b : "missing") << "'";
  }
}

}  // namespace splinecast::testing
