#include "splinecast/status.hpp"

#include <array>
#include <charconv>

#include "splinecast/producer.hpp"

namespace splinecast {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6);
  return {text.begin(), end.ptr};
}

}  // namespace

std::string_view to_string(AppendStatus status) noexcept {
  switch (status) {
    case AppendStatus::accepted:
      return "accepted";
    case AppendStatus::full:
      return "full";
    case AppendStatus::past:
      return "past";
    case AppendStatus::duplicate:
      return "duplicate";
    case AppendStatus::out_of_order:
      return "out of order";
    case AppendStatus::not_finite:
      return "not finite";
    case AppendStatus::too_close:
      return "too close";
    case AppendStatus::too_far_apart:
      return "too far apart";
    case AppendStatus::wrong_dimension:
      return "wrong dimension";
    case AppendStatus::too_late:
      return "too late";
    case AppendStatus::too_many:
      return "too many";
    case AppendStatus::already_started:
      return "already started";
    case AppendStatus::finished:
      return "finished";
    case AppendStatus::cannot_follow:
      return "cannot follow";
    case AppendStatus::too_far_ahead:
      return "too far ahead";
    case AppendStatus::elsewhere:
      return "elsewhere";
    case AppendStatus::stopped:
      return "stopped";
  }
  return "unknown";
}

std::string_view to_string(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::past:
      return "past";
    case Refusal::duplicate:
      return "duplicate";
    case Refusal::out_of_order:
      return "out of order";
    case Refusal::not_finite:
      return "not finite";
    case Refusal::too_close:
      return "too close";
    case Refusal::too_far_apart:
      return "too far apart";
    case Refusal::too_late:
      return "too late";
    case Refusal::after_finish:
      return "after finish";
    case Refusal::already_started:
      return "already started";
    case Refusal::unknown_kind:
      return "unknown kind";
    case Refusal::lacks_derivatives:
      return "lacks derivatives";
    case Refusal::lag_too_short:
      return "lag too short";
    case Refusal::zero_quaternion:
      return "quaternion of length 0";
    case Refusal::beyond_limits:
      return "beyond limits";
    case Refusal::cannot_follow:
      return "cannot follow";
    case Refusal::stopped:
      return "stopped";
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
    case SampleStatus::revised:
      return "revised";
    case SampleStatus::before_history:
      return "before history";
    case SampleStatus::no_data:
      return "no data";
    case SampleStatus::busy:
      return "busy";
    case SampleStatus::retired:
      return "retired";
    case SampleStatus::wrong_dimension:
      return "wrong dimension";
  }
  return "unknown";
}

std::string to_string(const ItemRefusal& refusal) {
  std::string text = "item " + std::to_string(refusal.item) + " refused: ";
  text += to_string(refusal.reason);
  if (!refusal.by.empty()) text += " by '" + refusal.by + "'";
  if (refusal.time) text += " (time " + std::to_string(refusal.time->count()) + " ns)";
  if (refusal.excess) text += ": " + in_words(*refusal.excess);
  return text;
}

std::string in_words(const LimitExcess& excess, std::span<const std::string> names) {
  std::string text(to_string(excess.kind));
  text += " of dimension " + std::to_string(excess.dimension);
  const bool has_name = excess.dimension < names.size() && !names[excess.dimension].empty();
  if (has_name) text += " (" + names[excess.dimension] + ")";
  return text + " is " + number(excess.value) + " at " + std::to_string(excess.time.count()) +
         " ns, limit " + number(excess.limit);
}

}  // namespace splinecast
