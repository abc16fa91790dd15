#pragma once

#include <string>

#include "apps/tables/waypoints.hpp"

namespace splinecast::apps {

/// The rows of a table in memory, which must exist as long as the reader.
class TableRows final : public RowReader {
 public:
  explicit TableRows(const WaypointTable& table);
  [[nodiscard]] const std::string& name() const override { return table_.file; }
  [[nodiscard]] const RowColumns& columns() const override { return columns_; }
  bool next(Row& row) override;
  void rewind() override { next_ = 0; }
  [[nodiscard]] std::string where(std::size_t number) const override;
  [[nodiscard]] std::string_view row_name() const noexcept override { return table_.row_name(); }
  [[nodiscard]] double fraction_read() const override;

 private:
  const WaypointTable& table_;
  RowColumns columns_;
  std::size_t next_ = 0;
};

}  // namespace splinecast::apps
