#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Raises a live stream's settled word between two steps of its solver, where a step would do no
/// more than that: S1 of publication.hpp. A step uses far more memory. The solver makes it after
/// each step; it is valid until the next one, which takes up what has been stored. Used by the
/// solver's thread.
class SettledRaise {
 public:
  /// Raises nothing.
  SettledRaise() = default;

  /// `stands` is what the word holds. Nothing is raised up to `limit` or beyond, where the solver
  /// itself has something to do: it starves, or comes to rest.
  SettledRaise(Word& word, Time stands, Time freeze_ahead, Time limit) noexcept
      : word_(&word), stands_(stands), freeze_ahead_(freeze_ahead), limit_(limit) {}

  /// Says at `now` that the curve is settled until now + freeze-ahead. Returns whether that was all
  /// there is to do; else nothing is stored.
  bool raise(Time now) noexcept {
    if (word_ == nullptr || now >= limit_ - freeze_ahead_) return false;
    const Time t = now + freeze_ahead_;
    if (t <= stands_) return true;
    stands_ = t;
    store(*word_, to_word(t), std::memory_order_release);
    return true;
  }

  /// How long after one raise the next one is due.
  [[nodiscard]] Time interval() const noexcept { return freeze_ahead_ / 2; }

 private:
  Word* word_ = nullptr;
  Time stands_{};
  Time freeze_ahead_{};
  Time limit_{};
};

}  // namespace splinecast::ipc
