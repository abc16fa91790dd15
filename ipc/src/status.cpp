#include "splinecast/ipc/status.hpp"

namespace splinecast::ipc {

std::string_view to_string(AppendStatus status) noexcept {
  switch (status) {
    case AppendStatus::accepted:
      return "accepted";
    case AppendStatus::full:
      return "full";
    case AppendStatus::not_increasing:
      return "not increasing";
    case AppendStatus::not_finite:
      return "not finite";
    case AppendStatus::wrong_dimension:
      return "wrong dimension";
    case AppendStatus::interval_out_of_range:
      return "interval out of range";
    case AppendStatus::finished:
      return "finished";
  }
  return "unknown";
}

std::string_view to_string(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::not_increasing:
      return "not increasing";
    case Refusal::not_finite:
      return "not finite";
    case Refusal::interval_out_of_range:
      return "interval out of range";
    case Refusal::after_finish:
      return "after finish";
    case Refusal::unknown_kind:
      return "unknown kind";
    case Refusal::lacks_derivatives:
      return "lacks derivatives";
    case Refusal::lag_too_short:
      return "lag too short";
  }
  return "unknown";
}

std::string_view to_string(SampleStatus status) noexcept {
  switch (status) {
    case SampleStatus::settled:
      return "settled";
    case SampleStatus::provisional:
      return "provisional";
    case SampleStatus::stopping:
      return "stopping";
    case SampleStatus::holding:
      return "holding";
    case SampleStatus::before_history:
      return "before history";
    case SampleStatus::no_data:
      return "no data";
    case SampleStatus::busy:
      return "busy";
    case SampleStatus::retired:
      return "retired";
  }
  return "unknown";
}

}  // namespace splinecast::ipc
