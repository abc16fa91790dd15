#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/tables/rows.hpp"

namespace splinecast::apps {

/// The rows of another reader, of which the first ones stay in memory for later passes. So a short
/// file is read once, and a long one needs bounded memory.
class KeptRows final : public RowReader {
 public:
  /// Memory for the rows that stay.
  static constexpr std::size_t kMostBytes = std::size_t{52} << 20U;

  explicit KeptRows(std::unique_ptr<RowReader> rows) : rows_(std::move(rows)) {}
  [[nodiscard]] const std::string& name() const override { return rows_->name(); }
  [[nodiscard]] const RowColumns& columns() const override { return rows_->columns(); }
  bool next(Row& row) override;
  void rewind() override;
  [[nodiscard]] std::string where(std::size_t number) const override {
    return rows_->where(number);
  }
  [[nodiscard]] std::string_view row_name() const noexcept override { return rows_->row_name(); }
  [[nodiscard]] double fraction_read() const override { return rows_->fraction_read(); }

 private:
  /// What a row in memory has in addition to its time and its position.
  struct Form {
    std::size_t number = 0;
    bool has_velocity = false;
    bool has_acceleration = false;

    /// Of the row after this one, unless the file says otherwise.
    [[nodiscard]] Form next() const noexcept {
      return {number + 1, has_velocity, has_acceleration};
    }
    friend bool operator==(const Form&, const Form&) = default;
  };
  static constexpr std::size_t kBlockWords = std::size_t{1} << 16U;
  static constexpr std::size_t kMostErrors = 1000;

  bool read_on(Row& row);
  void keep(const Row& row);
  void take(Row& row);
  void put(std::vector<double>& block, std::uint64_t word);
  [[nodiscard]] std::uint64_t take_word();
  [[nodiscard]] std::vector<double>& block_with_room(std::size_t words);

  std::unique_ptr<RowReader> rows_;
  /// Words of 8 bytes, each block reserved once. A row has a word with its time and a bit, a word
  /// with its form if the bit is set, and its values.
  std::vector<std::vector<double>> blocks_;
  Form form_{};  ///< of the last row that was put into memory, or taken from it
  std::map<std::size_t, std::pair<std::size_t, std::string>>
      errors_;             ///< by index: number and message of a row that cannot be read
  std::size_t kept_ = 0;   ///< rows in memory, with those that cannot be read
  std::size_t next_ = 0;   ///< index of the next row
  std::size_t block_ = 0;  ///< of the next row, if it is in memory
  std::size_t word_ = 0;   ///< in that block
  std::size_t read_ = 0;   ///< rows that rows_ has read since its beginning
  bool is_full_ = false;   ///< no further rows are kept
};

}  // namespace splinecast::apps
