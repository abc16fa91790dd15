#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Raises a live stream's settled word between two steps of its solver, in place of a step that
/// would do nothing else: it touches far less memory than a step. The store is S1 of
/// publication.hpp. The solver creates an object after each step; it is valid until the next step,
/// which reads the stored word back. Used by the solver's thread.
class SettledRaise {
 public:
  /// Raises nothing.
  SettledRaise() = default;

  /// `current`: the value of the word. Never raises the word to `limit` or later: there
  /// the solver itself has work to do, because the stream starves, comes to rest, or decides its
  /// start.
  SettledRaise(Word& word, Time current, Time settle_ahead, Time limit) noexcept
      : word_(&word), current_(current), settle_ahead_(settle_ahead), limit_(limit) {}

  /// Stores at `now` that the curve is settled until now + freeze-ahead. Returns false, and stores
  /// nothing, if a step is needed.
  bool raise(Time now) noexcept {
    if (word_ == nullptr || now >= limit_ - settle_ahead_) return false;
    const Time t = now + settle_ahead_;
    if (t <= current_) return true;
    current_ = t;
    store(*word_, to_word(t), std::memory_order_release);
    return true;
  }

  /// The time from one raise until the next one is due.
  [[nodiscard]] Time interval() const noexcept { return settle_ahead_ / 2; }

 private:
  Word* word_ = nullptr;
  Time current_{};
  Time settle_ahead_{};
  Time limit_{};
};

}  // namespace splinecast::ipc
