#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/mcap/format/parsed.hpp"
#include "apps/mcap/output/file_writer.hpp"

namespace splinecast::apps::mcap {

/// What recover() kept and lost.
struct Recovery {
  Statistics kept;
  bool was_complete = false;  ///< whether the file had a footer
  std::uint64_t lost_chunks = 0;
  std::uint64_t lost_bytes = 0;  ///< of the file that are in no kept record: in chunks, compressed
  /// Number of lost messages; nothing if the file has no statistics.
  std::optional<std::uint64_t> lost_messages;
  /// Places of damage, with reasons: at most kMostDamages.
  std::vector<std::string> damages;
  std::uint64_t further_damages = 0;  ///< those that are not listed

  [[nodiscard]] bool is_whole() const noexcept { return was_complete && damages.empty(); }
};

inline constexpr std::size_t kMostDamages = 20;

/// Writes a complete file with all whole chunks, messages, metadata and attachments of a file that
/// is cut off or damaged. Copies chunks as they are. Puts messages that were outside of chunks into
/// chunks. Leaves out a chunk with a wrong checksum, and one with a message whose channel is not
/// described in the rest of the file. Leaves out a message outside of chunks after a chunk, unless
/// the checksum of all data is right. After a damaged record it continues at the next chunk. Keeps
/// records of applications (opcodes from 0x80), and leaves out other unknown records.
///
/// Needs twice the memory of a Reader, and 16 bytes for each message of a chunk. Stops if Write
/// returns false. `name` is as for a Reader. Throws InputError if the file is not an MCAP file,
/// Failure as Reader does.
[[nodiscard]] Recovery recover(const std::string& name, std::span<const std::byte> file,
                               Write write);

}  // namespace splinecast::apps::mcap
