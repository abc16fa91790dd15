#pragma once

namespace splinecast::core {

/// The derivatives of a time law by host time, at one instant.
struct LawRates {
  double rate = 1;       ///< ṡ
  double slope = 0;      ///< s̈ [1/s]
  double curvature = 0;  ///< s⃛ [1/s²]
};

/// Turns the derivatives of a curve by stream time into those by host time:
///
///     v = x′ ṡ      a = x″ ṡ² + x′ s̈      j = x‴ ṡ³ + 3 x″ ṡ s̈ + x′ s⃛
///
/// Source: math 30.
class ChainRule {
 public:
  explicit ChainRule(const LawRates& law) noexcept
      : law_(law),
        squared_(law.rate * law.rate),
        cubed_(squared_ * law.rate),
        mixed_(3 * law.rate * law.slope) {}

  /// `Lane` is a double, or a vector of them.
  template <typename Lane>
  [[gnu::always_inline]] inline void apply(Lane& velocity, Lane& acceleration,
                                           Lane& jerk) const noexcept {
    jerk = jerk * cubed_ + acceleration * mixed_ + velocity * law_.curvature;
    acceleration = acceleration * squared_ + velocity * law_.slope;
    velocity = velocity * law_.rate;
  }

 private:
  LawRates law_;
  double squared_;
  double cubed_;
  double mixed_;
};

}  // namespace splinecast::core
