#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/watch/batch.hpp"
#include "splinecast/status.hpp"

namespace splinecast::apps::record {

/// The name of an event, in messages, in `--on` and in the names of files.
[[nodiscard]] std::string_view to_string(EventKind kind) noexcept;

/// The kind with this name, if `--on` accepts it.
[[nodiscard]] std::optional<EventKind> parse_trigger(std::string_view name) noexcept;
/// The names that `--on` accepts, separated by commas.
[[nodiscard]] std::string trigger_names();

/// Adds an event to a batch. `members`: further members of its JSON object; may be empty.
void add_event(Batch& batch, const EventNote& event, Time time, Time own_time,
               const std::string& members);

/// Adds what was lost of a stream, as a message and, if it is anything, as an event.
void add_loss(Batch& batch, std::uint32_t stream, const Loss& loss, Time time);

/// Members of the JSON object of an event `limit`. `names`: of the dimensions.
[[nodiscard]] std::string members_of(const LimitExcess& excess,
                                     const std::vector<std::string>& names);
/// Those that say where a limit is exceeded, and those that say by how much.
[[nodiscard]] std::string place_of(const LimitExcess& excess,
                                   const std::vector<std::string>& names);
[[nodiscard]] std::string values_of(const LimitExcess& excess);

}  // namespace splinecast::apps::record
