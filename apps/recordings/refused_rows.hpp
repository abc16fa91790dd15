#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"

namespace splinecast::apps {

/// `kind`, `dimension`, `time_ns`, `value`, `limit`.
[[nodiscard]] nlohmann::ordered_json to_json(const LimitExcess& excess);

/// Who refused a row.
enum class RefusedBy : std::uint8_t {
  file,      ///< it cannot be read, or the ring would refuse it: never sent
  producer,  ///< the append refused it: not in the ring
  solver,    ///< the ring had accepted it
};
inline constexpr std::size_t kRefusedBy = 3;

/// The reason of a row that cannot be read.
inline constexpr std::string_view kUnreadable = "unreadable";

/// A row of a recording that is not interpolated.
struct RefusedRow {
  RefusedBy by{};
  std::string_view reason;              ///< kUnreadable, or from to_string()
  std::optional<std::size_t> number{};  ///< see Row::number; unset: not a row of the file
  std::optional<ipc::Word> item{};      ///< number in the ring; if the solver refused it
  std::optional<std::size_t> loop{};    ///< from 1; if the row was played
  std::optional<LimitExcess> excess{};  ///< if the row exceeds limits
};

/// The rows of a recording that are not interpolated. Reports each on standard error at once and
/// counts it; keeps the first kListed for the report. Allocates.
class RefusedRows {
 public:
  static constexpr std::size_t kListed = 65'536;

  /// Adds a row and prints the message. `row.reason` must be a string literal.
  void add(const RefusedRow& row, std::string_view message);

  /// Counts refusals by the solver whose details are lost: the board keeps only the last ones.
  void add_unnamed(ipc::Word count) noexcept { unlisted_ += count; }

  /// The number of refused rows, by who refused them and by reason.
  [[nodiscard]] ipc::Word count(RefusedBy by) const noexcept;
  [[nodiscard]] ipc::Word count(RefusedBy by, std::string_view reason) const noexcept;

  /// Refusals that are counted but not listed.
  [[nodiscard]] ipc::Word unlisted() const noexcept { return unlisted_; }

  /// The listed rows in the order of add(): their number (may be null) under `row_name`, see
  /// RowReader::row_name(), `by`, `reason`, and, if set, `item`, `loop` and `beyond`.
  [[nodiscard]] nlohmann::ordered_json to_json(std::string_view row_name) const;

 private:
  struct Count {
    RefusedBy by{};
    std::string_view reason;
    ipc::Word count = 0;
  };

  std::vector<RefusedRow> rows_;
  std::vector<Count> counts_;
  ipc::Word unlisted_ = 0;
};

}  // namespace splinecast::apps
