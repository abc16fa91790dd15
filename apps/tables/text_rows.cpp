#include "apps/tables/text_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/column_roles.hpp"

namespace splinecast::apps {
namespace {

/// The beginning of a text, for opening it. Leaves `lines` before the first row.
FileBeginning beginning_of(const InputFile& file, LineReader& lines) {
  FileBeginning beginning{.name = file.name(), .bytes = {}, .is_text = true};
  read_beginning(lines, beginning);
  if (beginning.first_number > 0) return beginning;
  throw InputError(fmt::format("{}: there are no rows", file.name()));
}

/// The rows of a text.
class TextRows final : public RowReader {
 public:
  TextRows(InputFile file, ReadTextFormat read_format, const TableOptions& options)
      : file_(std::move(file)),
        lines_(file_),
        format_(read_format(beginning_of(file_, lines_))),
        first_row_(format_.is_first_a_row ? lines_.before_last() : lines_.place()),
        roles_(find_roles(options)),
        targets_(find_targets()),
        values_(values_of(roles_)) {
    for (const std::size_t c : roles_.positions) {
      columns_.names.push_back(format_.names[c]);
      if (!format_.aliases.empty()) columns_.aliases.push_back(format_.aliases[c]);
    }
    lines_.go_to(first_row_);
  }

  [[nodiscard]] const std::string& name() const override { return file_.name(); }
  [[nodiscard]] const RowColumns& columns() const override { return columns_; }

  bool next(Row& row) override {
    row.number = 0;
    if (!lines_.next_data(line_)) return false;
    row.number = line_.number;
    if (!read_plain(row)) read(row);
    row.position = part(0, roles_.positions);
    row.velocity = part(roles_.positions.size(), roles_.velocities);
    row.acceleration =
        part(roles_.positions.size() + roles_.velocities.size(), roles_.accelerations);
    return true;
  }

  void rewind() override {
    file_.require_same();
    lines_.go_to(first_row_);
  }

  void skip(std::size_t rows) override {
    while (rows > 0 && lines_.next_data(line_)) --rows;
  }

  [[nodiscard]] std::string where(std::size_t number) const override {
    return fmt::format("{}:{}", name(), number);
  }

  [[nodiscard]] std::string_view row_name() const noexcept override { return kLineName; }

  [[nodiscard]] double fraction_read() const override {
    return file_.size() == 0
               ? 1
               : static_cast<double>(lines_.offset()) / static_cast<double>(file_.size());
  }

 private:
  Roles find_roles(const TableOptions& options) {
    ColumnRoles roles(file_.name(), format_, options);
    if (!options.only_times) roles.find_values(options, lines_, first_row_);
    return roles.roles();
  }
  static std::vector<double> values_of(const Roles& roles) {
    return std::vector<double>(roles.positions.size() + roles.velocities.size() +
                               roles.accelerations.size());
  }

  /// Reads the fields of a line, in any form, or finds what is wrong with it.
  void read(Row& row) {
    format_.split(line_.text, fields_);
    require_width();
    row.time = time();
    std::size_t count = 0;
    for (const auto* columns : {&roles_.positions, &roles_.velocities, &roles_.accelerations}) {
      for (const std::size_t c : *columns) values_[count++] = number(c);
    }
  }

  /// Reads a line whose fields are plain numbers, without splitting it first. Returns false for any
  /// other line.
  bool read_plain(Row& row) {
    if (format_.separating == '\0') return false;
    std::string_view text = line_.text;
    for (std::size_t c = 0; c < targets_.size(); ++c) {
      if (c > 0) {
        if (text.empty() || text.front() != format_.separating) return false;
        text.remove_prefix(1);
      }
      if (targets_[c] == kUnused) {
        const std::string_view field = text.substr(0, text.find(format_.separating));
        if (field.find('"') != std::string_view::npos) return false;
        text.remove_prefix(field.size());
      } else if (targets_[c] == kTime) {
        if (!take_time(text, roles_.unit, row.time)) return false;
      } else if (!take_number(text, values_[targets_[c]])) {
        return false;
      }
    }
    return text.empty() && is_time_in_range(row.time);
  }

  /// Where each field goes: an index of `values_`, or one of these.
  static constexpr std::size_t kTime = ~std::size_t{0};
  static constexpr std::size_t kUnused = kTime - 1;
  [[nodiscard]] std::vector<std::size_t> find_targets() const {
    std::vector<std::size_t> targets(format_.names.size(), kUnused);
    targets[roles_.time] = kTime;
    std::size_t count = 0;
    for (const auto* columns : {&roles_.positions, &roles_.velocities, &roles_.accelerations}) {
      for (const std::size_t c : *columns) targets[c] = count++;
    }
    return targets;
  }

  [[nodiscard]] std::span<const double> part(std::size_t begin,
                                             const std::vector<std::size_t>& columns) const {
    return std::span(values_).subspan(begin, columns.size());
  }

  void require_width() const {
    if (fields_.size() == format_.names.size()) return;
    throw InputError(fmt::format("{}:{}:1: {} fields, but there are {} columns", name(),
                                 line_.number, fields_.size(), format_.names.size()));
  }
  [[nodiscard]] Time time() const {
    const auto time = parse_time(fields_[roles_.time], roles_.unit);
    if (!time) fail(roles_.time, "is not a time");
    if (!is_time_in_range(*time)) {
      fail(roles_.time, "is not within ±(2^62 − 1) ns, about 146 years");
    }
    return *time;
  }
  [[nodiscard]] double number(std::size_t column) const {
    const auto value = parse_number(fields_[column]);
    if (!value) fail(column, "is not a number");
    return *value;
  }
  [[noreturn]] void fail(std::size_t column, const char* what) const {
    const std::string_view field = fields_[column];
    throw InputError(fmt::format("{}:{}:{}: column '{}': '{}' {}", name(), line_.number,
                                 field.data() - line_.text.data() + 1, shown(format_.names[column]),
                                 shown(trimmed(field)), what));
  }

  InputFile file_;
  LineReader lines_;
  TextFormat format_;
  LineReader::Place first_row_;
  Roles roles_;
  std::vector<std::size_t> targets_;
  std::vector<double> values_;  ///< of the last row: positions, velocities, accelerations
  RowColumns columns_;
  Line line_;
  std::vector<std::string_view> fields_;
};

}  // namespace

void read_beginning(LineReader& lines, FileBeginning& beginning) {
  constexpr std::size_t kMostComments = 1000;
  Line line;
  while (lines.next(line)) {
    const std::string_view text = without_blanks(line.text);
    if (text.empty()) continue;
    if (text.front() != '#') {
      beginning.first = text;
      beginning.first_number = line.number;
      return;
    }
    if (beginning.comments.size() == kMostComments) {
      beginning.comments.erase(beginning.comments.begin());
    }
    beginning.comments.emplace_back(without_blanks(text.substr(1)));
  }
}

std::unique_ptr<RowReader> open_text(InputFile file, ReadTextFormat read,
                                     const TableOptions& options) {
  const bool is_for_topics = !options.topic.empty() || !options.fields.empty() ||
                             !options.joints.empty() || options.which_time != WhichTime::header;
  if (is_for_topics) {
    throw InputError(fmt::format(
        "{}: is a text: --topic, --joints, --field and --time are for MCAP files and ULogs",
        file.name()));
  }
  return std::make_unique<TextRows>(std::move(file), read, options);
}

std::vector<std::string> column_names(std::string_view line, Split split) {
  std::vector<std::string_view> fields;
  split(line, fields);
  std::vector<std::string> names;
  names.reserve(fields.size());
  for (const auto field : fields) names.emplace_back(trimmed(field));
  return names;
}

}  // namespace splinecast::apps
