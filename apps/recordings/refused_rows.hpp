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

/// A row of a recording that is not interpolated.
struct RefusedRow {
  RefusedBy by{};
  std::string_view reason;              ///< `unreadable`, or as to_string has it
  std::optional<std::size_t> line{};    ///< in the file, from 1; unset: the item is no row of ours
  std::optional<ipc::Word> item{};      ///< number in the ring; of the solver's only
  std::optional<std::size_t> loop{};    ///< from 1; of what was played only
  std::optional<LimitExcess> excess{};  ///< of one beyond limits
};

/// The rows of a recording that are not interpolated. Each is named on standard error as soon as it
/// is known and counted; the first kListed are kept for the report. Allocates.
class RefusedRows {
 public:
  static constexpr std::size_t kListed = 65'536;

  /// Takes a row over and says the message. `row.reason` must be a literal.
  void add(const RefusedRow& row, std::string_view message);

  /// Counts refusals of the solver of which nothing but their number is known any more.
  void add_unnamed(ipc::Word count) noexcept { unlisted_ += count; }

  /// How many were refused, by whom and for what.
  [[nodiscard]] ipc::Word count(RefusedBy by) const noexcept;
  [[nodiscard]] ipc::Word count(RefusedBy by, std::string_view reason) const noexcept;

  /// Refusals that are counted but not listed.
  [[nodiscard]] ipc::Word unlisted() const noexcept { return unlisted_; }

  /// The listed ones in the order in which they became known: `by`, `reason`, `line` (null: none),
  /// and, where there is one, `item` and `loop`.
  [[nodiscard]] nlohmann::ordered_json to_json() const;

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
