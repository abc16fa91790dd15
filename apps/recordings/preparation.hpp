#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/recordings/gaps.hpp"
#include "apps/recordings/late_rows.hpp"
#include "apps/recordings/refused_rows.hpp"
#include "apps/tables/rows.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/dimension_kind.hpp"

/// Preparation of the rows of a recording, before they are sent.
namespace splinecast::apps {

/// How the rows are prepared.
struct Preparation {
  std::optional<Time> from{};      ///< time after the first row at which to begin
  std::optional<Time> duration{};  ///< length of the part, in time of the recording
  double rate = 1;  ///< divides times, multiplies velocities, and accelerations by its square
  ipc::IntervalRange intervals{};
  LatePolicy late = LatePolicy::refuse;
  GapOptions gap{.policy = GapPolicy::bridge};
};

/// A prepared row: its time and values are those to send. Valid until the next call.
struct PreparedRow : Row {
  bool follows_gap = false;  ///< a gap precedes it, which is to be split
};

/// Prepares one row after the other: the same rows in each pass.
///
/// Selects the rows within `from` and `duration`, and applies the rate. Refuses rows that cannot be
/// read and rows that the ring would refuse: adds each to `refused`, with a message that has row
/// and value; without `refused`, throws InputError for the first one. Counts rows whose time is not
/// after that of the row before, and applies the policy to them: `pass` leaves them out; `shift`
/// leaves out copies of the row before and moves any other row, with all rows after it, to one
/// `step` after the row before. Counts gaps; with GapPolicy::refuse throws InputError for the first
/// one. With GapPolicy::split a gap may be longer than the maximum interval.
class PreparedRows {
 public:
  PreparedRows(RowReader& rows, std::vector<Dimension> kinds, const Preparation& how);

  /// The median interval of the recording, which step and gaps depend on. Set it before next().
  void set_median(Time median) noexcept;

  /// Reads the next row that remains. With `is_repeated`, the pass repeats an earlier one: refused
  /// rows are left out without a message.
  bool next(PreparedRow& row, RefusedRows* refused, bool is_repeated = false);

  /// Reads the next row within `from` and `duration`, without any other preparation except the
  /// rate. For measuring intervals. Leaves out rows that cannot be read.
  bool next_selected(Row& row);

  void rewind();

  [[nodiscard]] const RowReader& rows() const noexcept { return rows_; }
  [[nodiscard]] const std::vector<Dimension>& kinds() const noexcept { return kinds_; }

  /// Whether this pass has read a row, and one within `from` and `duration`.
  [[nodiscard]] bool has_rows() const noexcept { return state_.first.has_value(); }
  [[nodiscard]] bool has_selected() const noexcept { return state_.selected.has_value(); }

  /// Of the rows since the beginning of this pass.
  [[nodiscard]] const LateRows& late() const noexcept { return state_.late; }
  [[nodiscard]] const Gaps& gaps() const noexcept { return state_.gaps; }

 private:
  /// The reason for which the ring or the solver would refuse a row.
  struct Objection {
    std::string_view reason;
    std::string message;  ///< with the row's place and the offending value
  };
  /// What depends on the rows so far.
  struct State {
    std::optional<Time> first{};     ///< recorded time of the first row of the file
    std::optional<Time> selected{};  ///< recorded time of the first selected row
    bool has_last = false;
    Time last_recorded{};       ///< of the last row that remains
    Time last{};                ///< its time after the rate, without shifts
    std::size_t last_number{};  ///< its number
    LateRows late{};
    Gaps gaps{};
  };

  [[nodiscard]] bool is_selected(Time t);
  void apply_rate(Row& row);
  bool judge(PreparedRow& row, Time recorded, RefusedRows* refused, bool is_repeated);
  [[nodiscard]] std::optional<Objection> judge_values(const Row& row) const;
  [[nodiscard]] std::optional<Objection> time_refusal(const Row& row, bool is_split) const;
  [[nodiscard]] Objection objection(const Row& row, AppendStatus status,
                                    const std::string& value) const;
  [[nodiscard]] std::string value_in(const Row& row) const;
  bool note_gap(const Row& row, Time recorded);
  bool keeps_late(PreparedRow& row, Time recorded, RefusedRows* refused, bool is_repeated);
  bool keep(PreparedRow& row, Time recorded);
  bool refuse(const Row& row, const Objection& objection, RefusedRows* refused, bool is_repeated);
  [[nodiscard]] bool is_copy_of_last(const Row& row) const;
  [[nodiscard]] Time moved(Time time) const { return saturated_sum(time, state_.late.shifted); }

  RowReader& rows_;
  std::vector<Dimension> kinds_;
  DimensionKinds dimension_kinds_;
  Preparation how_;
  Time step_{};                                  ///< from the row before to a row that is shifted
  Time gap_{};                                   ///< longest interval that is not a gap
  std::array<std::vector<double>, 3> last_{};    ///< values of the last row, with LatePolicy::shift
  std::array<std::vector<double>, 2> scaled_{};  ///< velocities and accelerations after the rate
  State state_{};
};

}  // namespace splinecast::apps
