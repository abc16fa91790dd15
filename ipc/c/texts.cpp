#include <string>
#include <vector>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/enums.hpp"
#include "ipc/arguments/guard.hpp"
#include "ipc/arguments/refusals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/status.hpp"

/// Texts of errors, statuses and refusals. Those of the library's statuses are literals, so that a
/// zero byte follows each.
using namespace splinecast;
using namespace splinecast::ipc;

namespace {

/// The text of a number below `count`; the library writes "unknown" for others of the enum.
template <typename Enum>
const char* text_of(int number, int count) noexcept {
  if (number < 0 || number >= count) return "unknown";
  return to_string(static_cast<Enum>(number)).data();
}

}  // namespace

extern "C" {

const char* splinecast_last_error(void) { return last_failure(); }

const char* splinecast_strerror(int result) {
  if (result >= 0) return "no error";
  switch (result) {
    case SPLINECAST_ERROR_ARGUMENT:
      return "an argument cannot be used";
    case SPLINECAST_ERROR_NO_STREAM:
      return "there is no such stream";
    case SPLINECAST_ERROR_BUSY:
      return "another living process owns the stream";
    case SPLINECAST_ERROR_REGION:
      return "the shared region must not be used";
    case SPLINECAST_ERROR_RESOURCES:
      return "no memory or file descriptor is left";
    case SPLINECAST_ERROR_INTERNAL:
      return "a defect of the library";
    default:
      return "unknown error";
  }
}

const char* splinecast_append_text(int append_status) {
  return text_of<AppendStatus>(append_status, kAppendStatuses);
}

const char* splinecast_refusal_text(int refusal_reason) {
  return text_of<Refusal>(refusal_reason, kRefusals);
}

const char* splinecast_sample_text(int sample_status) {
  return text_of<SampleStatus>(sample_status, kSampleStatuses);
}

const char* splinecast_outcome_text(int outcome_kind) {
  return text_of<OutcomeKind>(outcome_kind, kOutcomeKinds);
}

const char* splinecast_way_text(int outcome_way) {
  return text_of<OutcomeWay>(outcome_way, kOutcomeWays);
}

const char* splinecast_wait_text(int wait_status) {
  switch (wait_status) {
    case SPLINECAST_WAIT_ADVANCED:
      return "advanced";
    case SPLINECAST_WAIT_TIMED_OUT:
      return "timed out";
    case SPLINECAST_WAIT_RETIRED:
      return "retired";
    default:
      return "unknown";
  }
}

int splinecast_has_values(int sample_status) {
  return sample_status >= 0 && sample_status <= SPLINECAST_SAMPLE_REVISED ? 1 : 0;
}

int splinecast_refusal_message(const splinecast_refusal* refusal, char* text, size_t capacity) {
  return guarded([&] {
    return put_text(to_string(read_refusal(*require_pointer(refusal, "refusal"))), text, capacity);
  });
}

int splinecast_time_message(int64_t time, char* text, size_t capacity) {
  return guarded([&] { return put_text(compared_with_now(Time(time)), text, capacity); });
}

int splinecast_excess_message(const splinecast_limit_excess* excess, const char* name, char* text,
                              size_t capacity) {
  return guarded([&] {
    const LimitExcess found = read_excess(*require_pointer(excess, "excess"), "excess");
    if (name == nullptr) return put_text(in_words(found), text, capacity);
    std::vector<std::string> names(found.dimension + 1);
    names.back() = require_text(name, "name");
    return put_text(in_words(found, names), text, capacity);
  });
}

}  // extern "C"
