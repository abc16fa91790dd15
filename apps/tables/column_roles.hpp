#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/files/line_reader.hpp"
#include "apps/files/numbers.hpp"
#include "apps/tables/text_rows.hpp"

namespace splinecast::apps {

/// The roles of the fields of a row.
struct Roles {
  std::size_t time = 0;
  TimeUnit unit = TimeUnit::seconds;
  std::vector<std::size_t> positions{};
  std::vector<std::size_t> velocities{};     ///< one per position, or none
  std::vector<std::size_t> accelerations{};  ///< one per position, or none
};

/// Determines the roles of a table's columns from their names. O(n log n) for n columns, plus one
/// read of each field until every column has had a number.
class ColumnRoles {
 public:
  /// Finds the time column: the requested one, else the first with the name of a time. `file` is
  /// for messages. Throws InputError if there is none, or if two columns have the same name.
  ColumnRoles(std::string file, const TextFormat& format, const TableOptions& options);

  /// Finds the columns of positions and given derivatives. `options.columns` names the positions in
  /// order. If it is empty, all numeric columns without another role are positions, and a message
  /// lists the roles, unless `quiet`, if a name is ambiguous. The rows begin at `first_row`; reads
  /// them until each column has had a number. Throws InputError with the column for one that looks
  /// like a time or a derivative but cannot be used, and for more than 64 positions.
  void find_values(const TableOptions& options, LineReader& lines,
                   const LineReader::Place& first_row);

  [[nodiscard]] const Roles& roles() const { return roles_; }

 private:
  using Columns = std::vector<std::size_t>;

  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  [[nodiscard]] std::size_t known_column(const std::string& wanted) const;
  [[nodiscard]] std::size_t selected_column(const std::string& wanted) const;
  [[nodiscard]] std::size_t time_column(const TableOptions& options) const;
  [[nodiscard]] Columns position_columns(const TableOptions& options,
                                         const std::vector<bool>& is_numeric);
  [[nodiscard]] std::vector<bool> numeric_columns(LineReader& lines) const;
  [[nodiscard]] bool is_sampled(const std::string& name) const;
  [[nodiscard]] Columns derivative_columns(std::string_view letter, const Columns& all) const;
  void leave_out(std::size_t c, std::string_view why);
  void require_usable(std::size_t c) const;
  void require_no_unused_derivative() const;
  void add_position(std::size_t c);
  void report_roles() const;
  [[nodiscard]] std::string names_of(const Columns& columns) const;
  [[nodiscard]] std::string all_names() const;

  std::string file_;
  const TextFormat& format_;
  std::map<std::string, std::size_t> index_;    ///< by name
  std::map<std::string, std::size_t> aliases_;  ///< by the name in a comment
  Roles roles_;
  bool is_time_requested_ = false;
  std::string left_out_;  ///< columns without a role, for the message
};

}  // namespace splinecast::apps
