#include "ipc/requests/record.hpp"

#include "ipc/layout/request_control.hpp"

namespace splinecast::ipc {

static_assert(kCommanderSequence == kRecordSequence && kCommanderNumber == kRecordWords);
static_assert(kStopperSequence == kRecordSequence && kStopperNumber == kRecordWords);

void write_record(std::span<Word> control, std::span<const Word> words) noexcept {
  Word& sequence = control[kRecordSequence];
  const Word odd = load(sequence, std::memory_order_relaxed) | 1;
  store(sequence, odd, std::memory_order_relaxed);
  for (std::size_t i = 0; i < words.size(); ++i) {
    store(control[kRecordWords + i], words[i], std::memory_order_release);
  }
  store(sequence, odd + 1, std::memory_order_release);
}

RecordCopy copy_record(std::span<const Word> control, std::span<Word> out) noexcept {
  constexpr int kTries = 4;
  RecordCopy copy;
  for (int i = 0; i < kTries && !copy.is_whole; ++i) {
    copy.sequence = load(control[kRecordSequence], std::memory_order_acquire);
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k] = load(control[kRecordWords + k], std::memory_order_acquire);
    }
    copy.is_whole = copy.sequence % 2 == 0 &&
                    load(control[kRecordSequence], std::memory_order_relaxed) == copy.sequence;
  }
  return copy;
}

}  // namespace splinecast::ipc
