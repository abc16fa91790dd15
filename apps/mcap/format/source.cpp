#include "apps/mcap/format/source.hpp"

#include <fmt/format.h>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {

void Source::refuse(std::uint64_t offset, std::string_view what) const {
  if (!chunk) throw InputError(fmt::format("{}: byte {}: {}", name, offset, what));
  throw InputError(
      fmt::format("{}: chunk at byte {}, byte {} of its records: {}", name, *chunk, offset, what));
}

}  // namespace splinecast::apps::mcap
