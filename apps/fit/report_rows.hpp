#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apps/fit/report_page.hpp"
#include "apps/fit/report_table.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// The breaks of all curves, ascending, each once.
[[nodiscard]] std::vector<Time> breaks_of(std::span<const ReportCurve> curves);

/// What the charts draw: values of all curves at the same times.
struct ReportRows {
  std::vector<double> seconds;  ///< from the first break; twice the same where values may jump
  double bucket = 0;            ///< seconds; if not 0, a pair of rows is the least and the greatest
                                ///< value of such an interval, in their order
  std::vector<double> values;   ///< [curve][dimension][derivative][row], NaN outside a curve

  /// The values of curve c of D dimensions.
  [[nodiscard]] std::span<const double> column(std::size_t c, std::size_t dimensions, std::size_t d,
                                               std::size_t derivative) const noexcept {
    const std::size_t at = (c * dimensions + d) * kDerivatives + derivative;
    return std::span(values).subspan(at * seconds.size(), seconds.size());
  }
};

/// Samples curves of equal dimensions, of which `tables` says the extremes, densely enough that
/// they look smooth: each break from both sides and between breaks, or, where that makes more than
/// 40000 rows, fewer the more curves and dimensions there are, but no fewer than 4000, the least
/// and greatest values of 2000 equal intervals.
[[nodiscard]] ReportRows rows_of(std::span<const ReportCurve> curves,
                                 std::span<const ReportTable> tables);

}  // namespace splinecast::apps
