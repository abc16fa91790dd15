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

/// The rows of the charts: values of all curves at the same times.
struct ReportRows {
  std::vector<double> seconds;  ///< from the first break; repeated where values may jump
  double bucket = 0;            ///< seconds; if not 0, each pair of rows is the least and greatest
                                ///< value of an interval of this length, in time order
  std::vector<double> values;   ///< [curve][dimension][derivative][row], NaN outside a curve

  /// The values of curve c of D dimensions.
  [[nodiscard]] std::span<const double> column(std::size_t c, std::size_t dimensions, std::size_t d,
                                               std::size_t derivative) const noexcept {
    const std::size_t at = (c * dimensions + d) * kDerivatives + derivative;
    return std::span(values).subspan(at * seconds.size(), seconds.size());
  }
};

/// Samples curves of equal dimensions, whose extremes are in `tables`, densely enough to look
/// smooth: each break from both sides, and between breaks. The number of rows has a limit: 40000,
/// less for many curves and dimensions, but at least 4000. Above this limit, returns the least and
/// greatest values of 2000 equal intervals instead.
[[nodiscard]] ReportRows rows_of(std::span<const ReportCurve> curves,
                                 std::span<const ReportTable> tables);

}  // namespace splinecast::apps
