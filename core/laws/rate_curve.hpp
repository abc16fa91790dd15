#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "splinecast/time.hpp"

/// The rate of a time law as a function of host time: what a law does, and what one commander alone
/// would make it do. Nothing allocates or throws. Source: math 31
/// and 32.
namespace splinecast::core {

/// A rate [stream time per host time], and its derivative by host time [1/s].
struct RateState {
  double rate = 1;
  double slope = 0;
};

/// The state of a law at one instant of host time.
struct LawState {
  Time time{};          ///< host time
  double position = 0;  ///< s: stream time since the law's origin [s]
  double rate = 1;      ///< ṡ, at least 0
  double slope = 0;     ///< s̈ [1/s]
};

/// The state after a piece that begins in a state and leads to a rate with slope 0. The piece is
/// the quintic between the two states, which is a quartic: its rate is the cubic of RatePiece.
[[nodiscard]] LawState end_of_piece(const LawState& from, double rate, Time length) noexcept;

/// A part of a rate curve: the cubic Hermite interpolant from a rate and a slope to an end rate
/// with slope 0. Its length is above 0.
struct RatePiece {
  Time begin{};
  Time length{};
  RateState from{};
  double end_rate = 1;

  [[nodiscard]] Time end() const noexcept { return begin + length; }
  [[nodiscard]] RateState at(Time time) const noexcept;
  /// Largest magnitude of the slope.
  [[nodiscard]] double steepest() const noexcept;
};

/// A rate that is constant but for at most kMostPieces contiguous pieces.
class RateCurve {
 public:
  static constexpr std::size_t kMostPieces = 3;

  /// A constant rate.
  explicit RateCurve(double rate) noexcept : last_rate_(rate) {}
  /// A curve that begins in a state at a time; add() appends its first piece. Without a piece it is
  /// constant.
  RateCurve(Time begin, const RateState& from) noexcept
      : begin_(begin), from_(from), last_rate_(from.rate) {}

  /// Appends a piece, from the end of the last one to this rate. Requires room for it.
  void add(double end_rate, Time length) noexcept;

  /// Where it begins; min() for a constant rate.
  [[nodiscard]] Time begin() const noexcept { return begin_; }
  [[nodiscard]] std::span<const RatePiece> pieces() const noexcept {
    return std::span(pieces_).first(count_);
  }
  /// The end of the last piece: the rate is constant from there on.
  [[nodiscard]] Time end() const noexcept {
    return count_ > 0 ? pieces_[count_ - 1].end() : begin_;
  }
  /// How long after `time` that is; 0 if it is before.
  [[nodiscard]] Time rest(Time time) const noexcept {
    return count_ > 0 && end() > time ? end() - time : Time::zero();
  }
  [[nodiscard]] double last_rate() const noexcept { return last_rate_; }
  [[nodiscard]] RateState at(Time time) const noexcept;
  /// Largest magnitude of the slope.
  [[nodiscard]] double steepest() const noexcept;

  /// The part at a time: a piece, or a constant rate until `end`, max() without end.
  struct Part {
    const RatePiece* piece = nullptr;
    double rate = 1;
    Time end = Time::max();

    [[nodiscard]] RateState at(Time time) const noexcept {
      return piece != nullptr ? piece->at(time) : RateState{rate, 0};
    }
  };
  [[nodiscard]] Part part_at(Time time) const noexcept;

 private:
  Time begin_ = Time::min();
  RateState from_{};
  double last_rate_;
  std::array<RatePiece, kMostPieces> pieces_{};
  std::size_t count_ = 0;
};

/// By how much a curve exceeds another one at most, at any time from `from` on; at most 0 if it
/// does nowhere. Exact but for rounding: the difference of two cubics has its extremes at the roots
/// of a quadratic.
[[nodiscard]] double largest_excess(const RateCurve& curve, const RateCurve& bound,
                                    Time from) noexcept;

}  // namespace splinecast::core
