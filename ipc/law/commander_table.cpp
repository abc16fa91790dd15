#include "ipc/law/commander_table.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::size_t kId = word_of(kCommanderFields, "id");
constexpr std::size_t kName = word_of(kCommanderFields, "name");
constexpr std::size_t kNumber = word_of(kCommanderFields, "number");
constexpr std::size_t kState = word_of(kCommanderFields, "state");
constexpr std::size_t kRenewed = word_of(kCommanderFields, "renewed");
constexpr std::size_t kRamp = word_of(kCommanderFields, "ramp");
constexpr std::size_t kBegin = word_of(kCommanderFields, "bound begin");
constexpr std::size_t kRate = word_of(kCommanderFields, "bound rate");
constexpr std::size_t kSlope = word_of(kCommanderFields, "bound slope");
constexpr std::size_t kEnds = word_of(kCommanderFields, "bound ends");
constexpr std::size_t kEndRates = word_of(kCommanderFields, "end rates");
constexpr std::size_t kPieces = 2;  ///< at most, of a bound

constexpr Word kAsks = 1;
constexpr Word kIsDead = 2;
constexpr Word kIsDamaged = 4;

}  // namespace

void write_entry(const CommanderEntry& entry, std::span<Word, kCommanderWords> to) noexcept {
  std::ranges::fill(to, 0);
  if (entry.id == 0) return;
  to[kId] = entry.id;
  std::memcpy(&to[kName], entry.name.data(), entry.name.size());
  to[kNumber] = entry.number;
  to[kState] = (entry.asks ? kAsks : 0) | (entry.is_dead ? kIsDead : 0) |
               (entry.is_damaged ? kIsDamaged : 0);
  to[kRenewed] = to_word(entry.renewed);
  to[kRamp] = to_word(entry.ramp);
  const auto pieces = entry.bound.pieces();
  to[kRate] = to_word(pieces.empty() ? entry.bound.last_rate() : pieces[0].from.rate);
  to[kBegin] = to_word(std::max(entry.bound.begin(), Time::zero()));
  if (pieces.empty()) return;
  to[kSlope] = to_word(pieces[0].from.slope);
  for (std::size_t i = 0; i < std::min(pieces.size(), kPieces); ++i) {
    to[kEnds + i] = to_word(pieces[i].end());
    to[kEndRates + i] = to_word(pieces[i].end_rate);
  }
}

std::optional<CommanderEntry> entry_of(std::span<const Word, kCommanderWords> words,
                                       double largest) noexcept {
  const auto is_rate = [largest](double rate) { return rate >= 0 && rate <= largest; };
  CommanderEntry entry{.id = words[kId], .number = words[kNumber]};
  if (entry.id == 0) return std::nullopt;
  std::memcpy(entry.name.data(), &words[kName], entry.name.size());
  entry.asks = (words[kState] & kAsks) != 0;
  entry.is_dead = (words[kState] & kIsDead) != 0;
  entry.is_damaged = (words[kState] & kIsDamaged) != 0;
  entry.renewed = to_time(words[kRenewed]);
  entry.ramp = to_time(words[kRamp]);
  const bool has_ramp = entry.ramp >= kShortestRamp && entry.ramp <= kLongestRamp;
  const double rate = to_double(words[kRate]);
  if (!has_ramp || !is_rate(rate)) return std::nullopt;
  const Time begin = to_time(words[kBegin]);
  if (begin < Time::zero() || begin > kLatestTime) return std::nullopt;
  if (words[kEnds] == 0) {
    const bool has_begin = begin > Time::zero();
    entry.bound =
        has_begin ? core::RateCurve(begin, {.rate = rate, .slope = 0}) : core::RateCurve(rate);
    return entry;
  }
  // The slope of a bound is at most that of its shortest pieces.
  constexpr double kSteepest = 1e12;
  const double slope = to_double(words[kSlope]);
  if (!(slope >= -kSteepest && slope <= kSteepest)) return std::nullopt;
  entry.bound = core::RateCurve(begin, {.rate = rate, .slope = slope});
  for (std::size_t i = 0; i < kPieces && words[kEnds + i] != 0; ++i) {
    const Time end = to_time(words[kEnds + i]);
    const double end_rate = to_double(words[kEndRates + i]);
    if (end <= entry.bound.end() || end > kLatestTime || !is_rate(end_rate)) return std::nullopt;
    entry.bound.add(end_rate, end - entry.bound.end());
  }
  return entry;
}

}  // namespace splinecast::ipc
