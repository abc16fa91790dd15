#include "apps/tables/column_roles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/time_column.hpp"
#include "splinecast/state.hpp"

namespace splinecast::apps {
namespace {

/// The text in the brackets of a column named `<word>[…]`.
std::optional<std::string_view> in_brackets(std::string_view name, std::string_view word) {
  if (!name.starts_with(word) || !name.ends_with(']')) return std::nullopt;
  name.remove_prefix(word.size());
  if (!name.starts_with('[')) return std::nullopt;
  return name.substr(1, name.size() - 2);
}

/// The index i of a column named `<word>[i]`.
std::optional<std::size_t> index_of(std::string_view name, std::string_view word) {
  const auto text = in_brackets(name, word);
  const bool has_digits =
      text && !text->empty() && text->find_first_not_of("0123456789") == std::string_view::npos;
  return has_digits ? parse_count(*text) : std::nullopt;
}

/// Whether a column named `<word>[…]` has an invalid index, such as `v[-1]`.
bool has_bad_index(std::string_view name, std::string_view word) {
  const auto text = in_brackets(name, word);
  if (!text || index_of(name, word)) return false;
  const std::string_view index = without_blanks(*text);
  return index.empty() || index.find_first_of("0123456789+-.") == 0;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// Whether a name may also mean a time or a derivative: `vx`, `acc_y`, `time_sync`.
bool is_ambiguous(std::string_view name) {
  constexpr std::array<std::string_view, 12> kWords{"vel",   "speed", "acc",   "jerk",
                                                    "omega", "alpha", "gyro",  "dot",
                                                    "rate",  "time",  "stamp", "sec"};
  constexpr std::size_t kLongestSymbol = 3;  // v, vx, v_x
  const std::string all = lower(name);
  const std::string_view base =
      without_blanks(std::string_view(all).substr(0, all.find_first_of(" [(")));
  const bool is_symbol = base.size() <= kLongestSymbol && base.find_first_of("vaj") == 0;
  return is_symbol || std::ranges::any_of(kWords, [&](std::string_view word) {
           return base.find(word) != std::string_view::npos;
         });
}

}  // namespace

ColumnRoles::ColumnRoles(std::string file, const TextFormat& format, const TableOptions& options)
    : file_(std::move(file)), format_(format), is_time_requested_(!options.time_column.empty()) {
  for (std::size_t c = 0; c < format_.names.size(); ++c) {
    const std::string& name = format_.names[c];
    if (!index_.emplace(name, c).second && !name.empty()) {
      throw InputError(fmt::format("{}: two columns are named '{}'", file_, shown(name)));
    }
    if (c < format_.aliases.size()) aliases_.emplace(format_.aliases[c], c);
  }
  roles_.time = time_column(options);
  const auto named = unit_of_time_column(format_.names[roles_.time]);
  roles_.unit = options.time_unit.value_or(named.value_or(TimeUnit::seconds));
}

std::size_t ColumnRoles::time_column(const TableOptions& options) const {
  if (is_time_requested_) return known_column(options.time_column);
  for (std::size_t c = 0; c < format_.names.size(); ++c) {
    if (unit_of_time_column(format_.names[c])) return c;
  }
  std::string hint = "--time-column NAME selects one";
  if (format_.names.size() == 1) {
    hint = "fields are separated by commas, semicolons or tabs, and this line has none of these";
  } else if (format_.split != split_at_commas) {
    hint += fmt::format("; this file has {} between its fields", format_.separator);
  }
  throw InputError(fmt::format(
      "{}: there is no time column (t_ns, timestamp_us, timestamp [ns], t, time, stamp, secs, "
      "%time) among {} ({})",
      file_, all_names(), hint));
}

void ColumnRoles::find_values(const TableOptions& options, LineReader& lines,
                              const LineReader::Place& first_row) {
  lines.go_to(first_row);
  const Columns all = position_columns(options, numeric_columns(lines));
  for (const std::string& wanted : options.columns) add_position(selected_column(wanted));
  if (options.columns.empty()) {
    for (const std::size_t c : all) add_position(c);
  }
  if (roles_.positions.empty()) {
    throw InputError(fmt::format("{}: there is no position column among {}", file_, all_names()));
  }
  roles_.velocities = derivative_columns("v", all);
  roles_.accelerations = derivative_columns("a", all);
  if (!options.columns.empty()) return;
  require_no_unused_derivative();
  if (!options.quiet) report_roles();
}

void ColumnRoles::add_position(std::size_t c) {
  if (roles_.positions.size() == kMaxDimensions) {
    throw InputError(fmt::format(
        "{}: column {}, '{}', would be the position of dimension {}; the maximum is {}: select "
        "positions with --columns",
        file_, c + 1, shown(format_.names[c]), kMaxDimensions + 1, kMaxDimensions));
  }
  roles_.positions.push_back(c);
}

std::optional<std::size_t> ColumnRoles::find(const std::string& name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

/// A column by name, or by its alias from a comment.
std::size_t ColumnRoles::known_column(const std::string& wanted) const {
  if (const auto c = find(wanted)) return *c;
  if (const auto alias = aliases_.find(wanted); alias != aliases_.end()) return alias->second;
  throw InputError(
      fmt::format("{}: there is no column '{}' among {}", file_, shown(wanted), all_names()));
}

/// A column that is selected as a position.
std::size_t ColumnRoles::selected_column(const std::string& wanted) const {
  const std::size_t c = known_column(wanted);
  const bool is_again = std::ranges::find(roles_.positions, c) != roles_.positions.end();
  if (c == roles_.time || is_again) {
    throw InputError(fmt::format("{}: column '{}' is {}", file_, shown(wanted),
                                 is_again ? "selected twice" : "the time"));
  }
  return c;
}

/// The columns that hold positions if none are selected: numeric ones without another role. Without
/// a selection, stops at the first column above kMaxDimensions.
ColumnRoles::Columns ColumnRoles::position_columns(const TableOptions& options,
                                                   const std::vector<bool>& is_numeric) {
  const bool is_selected = !options.columns.empty();
  Columns columns;
  for (std::size_t c = 0; c < format_.names.size(); ++c) {
    const std::string& name = format_.names[c];
    if (c == roles_.time || index_of(name, "v") || index_of(name, "a") || is_sampled(name)) {
      continue;
    }
    const bool is_other_time = is_time_requested_ && unit_of_time_column(name);
    if (!is_numeric[c] || (is_other_time && !is_selected)) {
      if (!is_selected) leave_out(c, is_numeric[c] ? "another time" : "not numeric");
      continue;
    }
    if (!is_selected) require_usable(c);
    columns.push_back(c);
    if (!is_selected && columns.size() > kMaxDimensions) break;
  }
  return columns;
}

/// Notes a column for the message about roles.
void ColumnRoles::leave_out(std::size_t c, std::string_view why) {
  constexpr std::size_t kMost = 1000;  // bytes of the list
  if (format_.names[c].empty() || left_out_.size() > kMost) return;
  left_out_ +=
      fmt::format("{}{} ({})", left_out_.empty() ? "" : ", ", shown(format_.names[c]), why);
}

/// For each column, whether at least one of its cells is a number. (One invalid cell must not
/// remove a dimension.)
std::vector<bool> ColumnRoles::numeric_columns(LineReader& lines) const {
  std::vector<bool> is_numeric(format_.names.size(), false);
  Columns open;
  for (std::size_t c = 0; c < is_numeric.size(); ++c) open.push_back(c);
  std::vector<std::string_view> fields;
  Line line;
  bool has_rows = false;
  while (!open.empty() && lines.next_data(line)) {
    has_rows = true;
    format_.split(line.text, fields);
    std::erase_if(open, [&](std::size_t c) {
      if (c < fields.size() && parse_number(fields[c])) is_numeric[c] = true;
      return is_numeric[c];
    });
  }
  if (!has_rows) is_numeric.assign(is_numeric.size(), true);
  return is_numeric;
}

/// Throws if the name of a default position column is that of a time or a derivative.
void ColumnRoles::require_usable(std::size_t c) const {
  const std::string& name = format_.names[c];
  if (unit_of_time_column(name)) {
    throw InputError(fmt::format(
        "{}: column {}, '{}', is a second time column after '{}': select the positions with "
        "--columns",
        file_, c + 1, shown(name), shown(format_.names[roles_.time])));
  }
  for (const std::string_view letter : {"v", "a"}) {
    if (!has_bad_index(name, letter)) continue;
    throw InputError(fmt::format(
        "{}: column {}, '{}', is not a valid {}: {}[i] has an index i from 0 to {}", file_, c + 1,
        shown(name), letter == "v" ? "velocity" : "acceleration", letter, kMaxDimensions - 1));
  }
}

/// Whether a column is the jerk or the angular motion of samples that this program wrote, and so
/// not a position: j[i] if p[i], v[i] and a[i] exist, omega[i] and alpha[i] if p[0] to j[0] exist.
bool ColumnRoles::is_sampled(const std::string& name) const {
  const bool is_angular = index_of(name, "omega") || index_of(name, "alpha");
  const auto i = is_angular ? 0 : index_of(name, "j");
  if (!i) return false;
  return std::ranges::all_of(std::string_view("pvaj"), [&](char letter) {
    return find(fmt::format("{}[{}]", letter, *i)).has_value();
  });
}

/// The columns of a derivative, one per selected position, or none. `<letter>[i]` belongs to the
/// column p[i] if it exists, else to the i-th position column of the file.
ColumnRoles::Columns ColumnRoles::derivative_columns(std::string_view letter,
                                                     const Columns& all) const {
  Columns columns;
  for (const std::size_t position : roles_.positions) {
    auto i = index_of(format_.names[position], "p");
    if (!i) i = static_cast<std::size_t>(std::ranges::lower_bound(all, position) - all.begin());
    const auto c = find(fmt::format("{}[{}]", letter, *i));
    if (c && std::ranges::find(roles_.positions, *c) == roles_.positions.end()) {
      columns.push_back(*c);
    }
  }
  if (!columns.empty() && columns.size() != roles_.positions.size()) {
    throw InputError(fmt::format("{}: {} columns {}[i] for {} positions; give one each, or none",
                                 file_, columns.size(), letter, roles_.positions.size()));
  }
  return columns;
}

/// Throws for a velocity or an acceleration that belongs to none of the positions.
void ColumnRoles::require_no_unused_derivative() const {
  for (std::size_t c = 0; c < format_.names.size(); ++c) {
    const std::string& name = format_.names[c];
    for (const auto& [letter, used] :
         {std::pair("v", &roles_.velocities), std::pair("a", &roles_.accelerations)}) {
      if (c == roles_.time || !index_of(name, letter)) continue;
      if (std::ranges::find(*used, c) != used->end()) continue;
      throw InputError(fmt::format("{}: column {}, '{}', belongs to none of the {} positions ({})",
                                   file_, c + 1, shown(name), roles_.positions.size(),
                                   names_of(roles_.positions)));
    }
  }
}

void ColumnRoles::report_roles() const {
  const bool is_clear =
      left_out_.empty() && std::ranges::none_of(roles_.positions, [&](std::size_t c) {
        return is_ambiguous(format_.names[c]);
      });
  if (is_clear) return;
  say(
      fmt::format("{}: time: {}; positions: {}; velocities: {}; accelerations: {}{}{} (--columns "
                  "selects other positions)",
                  file_, shown(format_.names[roles_.time]), names_of(roles_.positions),
                  names_of(roles_.velocities), names_of(roles_.accelerations),
                  left_out_.empty() ? "" : "; left out: ", left_out_));
}

std::string ColumnRoles::names_of(const Columns& columns) const {
  std::string text;
  for (const std::size_t c : columns) {
    text += (text.empty() ? "" : ", ") + shown(format_.names[c]);
  }
  return text.empty() ? "none" : text;
}

/// The names of all columns; of more than 100 columns, the first ones.
std::string ColumnRoles::all_names() const {
  constexpr std::size_t kMost = 100;
  Columns columns;
  for (std::size_t c = 0; c < std::min(format_.names.size(), kMost); ++c) columns.push_back(c);
  const std::size_t more = format_.names.size() - columns.size();
  return names_of(columns) + (more == 0 ? "" : fmt::format(" and {} more", more));
}

}  // namespace splinecast::apps
