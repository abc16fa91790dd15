#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/options.hpp"
#include "splinecast/time.hpp"
#include "tests/campaign/record/ranges.hpp"

namespace splinecast::campaign::record {

/// Numbers of items or of segments, from 0.
struct Numbers {
  Ranges recorded{};
  Ranges lost{};
};

/// A stream in one or several files.
struct StreamContents {
  Numbers items{};
  Numbers segments{};
  bool is_law = false;
  bool has_solver = false;
  std::uint64_t losses = 0;  ///< items, segments, refusals and others that are lost
  std::optional<apps::record::Account> account{};  ///< the newest one
  Time account_time{};
};

/// By name and id.
using Streams = std::map<std::pair<std::string, std::uint64_t>, StreamContents>;

/// What a recording has, read message by message.
struct FileContents {
  Streams streams{};
  bool is_cut_off = false;
  std::uint64_t repeated = 0;  ///< numbers that it has more than once
  std::uint64_t wrong = 0;     ///< waypoints that no source has sent
  std::uint64_t losses = 0;
};

/// Throws apps::InputError or apps::record::BadMessage for a file that is damaged.
[[nodiscard]] FileContents read_contents(const std::string& path);

/// Adds the streams of a further file.
void add(Streams& all, const Streams& further);

/// Joins the ranges of all streams.
void tidy(Streams& all);

}  // namespace splinecast::campaign::record
