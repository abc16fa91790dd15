#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "apps/trials/recovery.hpp"
#include "tests/campaign/kills/journal.hpp"

namespace splinecast::campaign {

/// The processes that a campaign can kill.
enum class Role : std::uint8_t { producer, solver, reader, remover };
inline constexpr std::size_t kRoles = 4;
[[nodiscard]] std::string_view to_string(Role role) noexcept;

/// Counters of an attack on one or several streams.
struct Findings {
  std::array<std::uint64_t, kRoles> kills{};
  std::array<apps::Recovery, kRoles> recovery;

  // Violations: each must be 0.
  std::uint64_t hangs = 0;
  std::uint64_t unusable = 0;   ///< starts that failed because of files of a killed process
  std::uint64_t clean_ups = 0;  ///< files that must be removed by hand
  std::uint64_t lost = 0;       ///< items neither taken nor refused nor withdrawn
  std::uint64_t torn = 0;       ///< this and the next four: see ReaderFacts
  std::uint64_t stepped = 0;
  std::uint64_t restless = 0;
  std::uint64_t changed = 0;
  std::uint64_t wrong = 0;

  // Amount of work.
  std::uint64_t lives = 0;        ///< streams that finished and were compared
  std::uint64_t waypoints = 0;    ///< interpolated ones
  std::uint64_t passed_over = 0;  ///< waypoints that entries pass over
  std::uint64_t refused = 0;      ///< items of live streams, each with a reason
  std::uint64_t withdrawn = 0;    ///< waypoints that a replacement withdrew
  std::uint64_t samples = 0;      ///< this and the next four: see ReaderFacts
  std::uint64_t busy = 0;
  std::uint64_t segments = 0;
  std::uint64_t items = 0;
  std::uint64_t ends = 0;

  void add(const Findings& other);
  void add(const ReaderFacts& facts);

  [[nodiscard]] std::uint64_t all_kills() const noexcept;

  /// Violations by name.
  [[nodiscard]] nlohmann::json found() const;

  /// Counters of the work by name.
  [[nodiscard]] nlohmann::json work() const;
  /// By name: kills per role, and times from a kill to the first sample of new data.
  [[nodiscard]] nlohmann::json killing() const;
};

}  // namespace splinecast::campaign
