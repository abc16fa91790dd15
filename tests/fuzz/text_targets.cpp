#include "tests/fuzz/text_targets.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/cli/verb.hpp"
#include "apps/files/lines.hpp"
#include "apps/files/numbers.hpp"
#include "apps/files/polynomial_file.hpp"
#include "apps/limits/file.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/recordings/advice.hpp"
#include "apps/recordings/recording.hpp"
#include "apps/tables/kept_rows.hpp"
#include "apps/tables/kinds.hpp"
#include "apps/tables/time_column.hpp"
#include "ipc/memory/names.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/waypoint.hpp"
#include "tests/fuzz/script.hpp"

namespace splinecast::fuzz {
namespace {

/// A file in memory with its own path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    if (descriptor_ < 0 ||
        write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      throw std::runtime_error("no memory for a file");
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

/// Removes the first line from a text and returns it.
std::string take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string line(text.substr(0, end));
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

apps::TableOptions options_of(const std::string& line) {
  apps::TableOptions options;
  std::vector<std::string_view> words;
  apps::split_at_blanks(line, words);
  for (const std::string_view word : words) {
    const auto kind = apps::parse_kind_option(std::string(word));
    const auto unit = apps::parse_time_unit(word);
    if (kind) options.kinds.push_back(*kind);
    if (unit) options.time_unit = unit;
    const bool is_time = word.starts_with('@');
    if (is_time) options.time_column = word.substr(1);
    if (!kind && !unit && !is_time) options.columns.emplace_back(word);
  }
  return options;
}

void require_whole(const apps::WaypointTable& table) {
  const std::size_t dimensions = table.dimensions();
  require(dimensions >= 1 && dimensions <= kMaxDimensions, "a table has 1 to 64 dimensions");
  require(table.lines.size() == table.size() && table.kinds.size() == dimensions,
          "a table has a line for each row and a kind for each dimension");
  for (const auto* values : {&table.velocities, &table.accelerations}) {
    require(values->empty() || values->size() == table.size() * dimensions,
            "a derivative exists for all positions or none");
  }
  require(table.positions.size() == table.size() * dimensions, "each row has each position");
  for (const Time t : table.times) require(is_time_in_range(t), "times are in range");
}

/// The rows of a pass, as their number and a value that depends on each of them.
std::pair<std::size_t, std::uint64_t> pass_over(apps::RowReader& rows) {
  std::pair<std::size_t, std::uint64_t> found{0, 0};
  const auto mix = [&found](std::uint64_t value) { found.second = found.second * 31 + value; };
  for (apps::Row row;; ++found.first) {
    try {
      if (!rows.next(row)) return found;
      mix(static_cast<std::uint64_t>(row.time.count()));
      for (const auto values : {row.position, row.velocity, row.acceleration}) {
        for (const double value : values) mix(std::bit_cast<std::uint64_t>(value));
      }
    } catch (const apps::InputError&) {
      if (row.number == 0) throw;
    }
    mix(row.number);
  }
}

/// Reads a file in several passes like `replay`.
void require_equal_passes(const std::string& path, const apps::TableOptions& options) {
  const auto reader = apps::open_rows(path, options);
  const auto first = pass_over(*reader);
  reader->rewind();
  require(pass_over(*reader) == first, "each pass reads the same rows");
  apps::KeptRows kept(apps::open_rows(path, options));
  for (int pass = 0; pass < 2; ++pass) {
    require(pass_over(kept) == first, "rows in memory are those of the file");
    kept.rewind();
  }
}

/// Prepares a table like `replay` and `advise`.
void prepare(apps::WaypointTable& table) {
  apps::WaypointTable shifted = table;
  apps::prepare(shifted, {.late = apps::LatePolicy::shift, .gap = {}}, nullptr);
  require_whole(shifted);
  apps::prepare(table, {.rate = 2}, nullptr);
  apps::continue_waypoints(table);
  (void)apps::advise(table, apps::SolvedHow{}.settle_ahead, std::nullopt, false);
}

}  // namespace

void try_waypoints(std::string_view text) {
  apps::TableOptions options = options_of(take_line(text));
  const MemoryFile file(text);
  std::size_t bad_rows = 0;
  try {
    apps::WaypointTable table = apps::read_waypoints(file.path(), options);
    require_whole(table);
    require_equal_passes(file.path(), options);
    prepare(table);
  } catch (const apps::InputError&) {
    ++bad_rows;
  }
  options.on_bad_row = [&bad_rows](std::size_t, const std::exception&) { ++bad_rows; };
  try {
    apps::WaypointTable table = apps::read_waypoints(file.path(), options);
    require_whole(table);
    apps::require_spline_input(table);
    apps::continue_waypoints(table);
  } catch (const apps::InputError&) {
    return;
  }
}

void try_times(std::string_view text) {
  const apps::TableOptions options = options_of(take_line(text));
  const MemoryFile file(text);
  try {
    for (const Time t : apps::read_times(file.path(), {.time_unit = options.time_unit})) {
      require(is_time_in_range(t), "times are in range");
    }
  } catch (const apps::InputError&) {
    return;
  }
}

void try_polynomials(std::string_view text) {
  const MemoryFile file(text);
  try {
    const apps::PolynomialFile read = apps::read_polynomials(file.path());
    require(read.curve.segments() > 0, "a file of polynomials has a piece");
    require(read.names.size() <= kMaxDimensions, "a file has at most 64 dimensions");
  } catch (const apps::InputError&) {
    return;
  }
}

void try_limits(std::string_view text) {
  const MemoryFile file(text);
  try {
    const apps::LimitFile read = apps::read_limit_file(file.path());
    for (const NamedLimits& joint : read.joints) {
      require_limits({.velocity = {joint.velocity},
                      .acceleration = {joint.acceleration},
                      .jerk = {joint.jerk},
                      .lower = {joint.lower},
                      .upper = {joint.upper}},
                     1);
    }
  } catch (const apps::InputError&) {
    return;
  }
}

void try_words(std::string_view text) {
  for (const std::string& line : lines_of(text)) {
    for (const auto unit : {apps::TimeUnit::nanoseconds, apps::TimeUnit::seconds}) {
      (void)apps::parse_time(line, unit);
    }
    (void)apps::parse_number(line);
    (void)apps::parse_count(line);
    if (const auto gap = apps::parse_gap(line); gap && gap->longer_than) {
      require(*gap->longer_than > Time::zero(), "a gap has a length");
    }
    (void)apps::unit_of_time_column(line);
    if (const auto kind = parse_dimension(line)) {
      require(parse_dimension(to_string(*kind)) == kind, "a printed kind parses to the same kind");
    }
    if (const auto condition = parse_condition(line)) {
      require(parse_condition(to_string(*condition)) == condition,
              "a printed condition parses to the same condition");
    }
    try {
      ipc::require_stream_name(line);
      require(line.find('/') == std::string::npos && line.front() != '.',
              "a stream's name stays in its folder");
    } catch (const BadRequest&) {
      continue;
    }
  }
}

void try_arguments(std::string_view text) {
  CLI::App program("Fuzzed", "splinecast");
  program.require_subcommand(1);
  apps::Action action;
  apps::Command command(program);
  apps::Verb::add_all(command, action);
  auto arguments = lines_of(text);
  std::reverse(arguments.begin(), arguments.end());  // the order that CLI11 expects
  try {
    program.parse(arguments);
    require(static_cast<bool>(action), "a valid command line has an action");
  } catch (const CLI::ParseError&) {
    return;
  } catch (const apps::UsageError&) {
    return;
  }
}

}  // namespace splinecast::fuzz
