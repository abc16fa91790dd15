#pragma once

#include <span>

#include "ipc/layout/common_control.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/requests/regions.hpp"
#include "ipc/solve/settled_raise.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Whether a solver has work to do, for a thread that polls many of them. Created after each step;
/// invalid once its solver has detached.
class SolverWatch {
 public:
  /// `requests` are those of a law's commanders, or of a live stream's stoppers; null for others.
  SolverWatch(std::span<const Word, 2> polled, Word seen, Time due, const SettledRaise& raise,
              const RequestRegions* requests) noexcept
      : polled_(polled), seen_(seen), due_(due), raise_(raise) {
    if (requests == nullptr) return;
    news_ = requests->news();
    seen_news_ = requests->seen_news();
    if (!requests->sources().empty() || requests->has_untried()) requests_ = requests;
  }

  /// Whether the ring has items that the last step did not see. One load of a word that only the
  /// producer writes.
  [[nodiscard]] bool has_items() const noexcept {
    return load(polled_[kWritten], std::memory_order_acquire) != seen_;
  }

  /// Whether a step is due at `now` without new items.
  [[nodiscard]] bool is_due(Time now) const noexcept { return due_ <= now; }

  /// Raises the stream's settled time if nothing else is due at `now`. Returns false if the stream
  /// needs a step instead. Stores at most one word.
  bool settle(Time now) noexcept {
    if (!raise_.raise(now)) return false;
    due_ = now + raise_.interval();
    return true;
  }

  /// Whether another process has caused work for a step: there are new items, the stream has been
  /// retired, or a commander or stopper has come, gone or made a request. Loads from one cache line
  /// of the stream, from one that all streams share, and from one per commander or stopper.
  [[nodiscard]] bool calls() const noexcept {
    return has_items() || load(polled_[kRetired], std::memory_order_acquire) != 0 ||
           (news_ != nullptr && *news_ != seen_news_) ||
           (requests_ != nullptr && requests_->calls());
  }

  /// When the next step is due without items; max() for never.
  [[nodiscard]] Time due() const noexcept { return due_; }

 private:
  std::span<const Word, 2> polled_;
  Word seen_;
  Time due_;
  SettledRaise raise_;
  const Word* news_ = nullptr;  ///< changes when a commander, or a stopper, comes or goes
  Word seen_news_ = 0;
  const RequestRegions* requests_ = nullptr;
};

}  // namespace splinecast::ipc
