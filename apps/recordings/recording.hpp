#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "apps/recordings/measures.hpp"
#include "apps/recordings/preparation.hpp"
#include "apps/tables/rows.hpp"
#include "apps/tables/waypoints.hpp"

namespace splinecast::apps {

/// What the first pass over a recording finds.
struct Survey {
  std::size_t rows = 0;   ///< that remain
  Time first{};           ///< prepared time of the first one
  Time last{};            ///< and of the last one
  Time longest{};         ///< interval between them
  Time median{};          ///< interval, of the first kMeasuredRows rows; 10 ms if there is none
  Intervals intervals{};  ///< between these, if there are at least two
  LateRows late{};
  Gaps gaps{};
};

/// A recording that is read in passes. The first pass checks and measures it, so that a bad row is
/// found before anything is sent. Memory does not depend on the length: the first rows stay in
/// memory (KeptRows), the others are read again in each pass.
class Recording {
 public:
  /// Intervals are measured between this many rows at the beginning.
  static constexpr std::size_t kMeasuredRows = std::size_t{1} << 18U;

  /// Makes the first pass. Adds refused rows to `refused`; without it, throws InputError for the
  /// first one. Throws InputError if no row remains, or if the recording takes longer than
  /// kLongestTime at this rate.
  Recording(std::unique_ptr<RowReader> rows, std::vector<Dimension> kinds, const Preparation& how,
            RefusedRows* refused);

  [[nodiscard]] const std::string& name() const { return rows_->name(); }
  [[nodiscard]] const RowColumns& columns() const { return rows_->columns(); }
  [[nodiscard]] const std::vector<Dimension>& kinds() const { return prepared_.kinds(); }
  [[nodiscard]] std::string where(std::size_t number) const { return rows_->where(number); }
  [[nodiscard]] std::string_view row_name() const noexcept { return rows_->row_name(); }
  [[nodiscard]] const Survey& survey() const noexcept { return survey_; }

  /// Reads the next row of a later pass, without messages. Throws InputError if the file has
  /// changed since the first pass.
  bool next(PreparedRow& row);

  /// Begins the next pass. Call it before the first next().
  void rewind();

 private:
  void look(RefusedRows* refused);

  std::unique_ptr<RowReader> rows_;
  PreparedRows prepared_;
  RefusedRows* refused_;
  Survey survey_{};
  std::size_t passed_ = 0;  ///< rows of this pass
};

/// The median of intervals, 10 ms if there are none. Changes their order.
[[nodiscard]] Time median_of(std::vector<Time>& intervals);

/// Prepares a table in memory, with the gaps and late rows that this finds. Otherwise as the first
/// pass of a Recording.
LateRows prepare(WaypointTable& table, const Preparation& how, RefusedRows* refused);

}  // namespace splinecast::apps
