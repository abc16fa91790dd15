#include <span>
#include <string>

#include "apps/mcap/input/reader.hpp"
#include "apps/mcap/input/recover.hpp"
#include "apps/process/exit_codes.hpp"
#include "tests/fuzz/script.hpp"
#include "tests/fuzz/text_targets.hpp"

namespace splinecast::fuzz {
namespace {

namespace mcap = apps::mcap;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Reads a file twice and returns the number of its messages.
std::uint64_t read(std::string_view file) {
  mcap::Reader reader("file", bytes_of(file));
  mcap::Message message;
  std::uint64_t bytes = 0;
  while (reader.next(message)) {
    bytes += message.data.size();
    require(message.channel != nullptr, "a message has a channel");
    require(message.log_time >= Time::zero() && message.publish_time >= Time::zero(),
            "times are not negative");
  }
  const std::uint64_t messages = message.number;
  reader.rewind();
  while (reader.next(message)) {
    bytes -= message.data.size();
  }
  require(bytes == 0 && message.number == messages, "both times the same messages");
  return messages;
}

}  // namespace

void try_recordings(std::string_view text) {
  try {
    (void)read(text);
  } catch (const apps::InputError&) {
    // damaged
  }
  std::string recovered;
  const auto write = [&recovered](std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) recovered.push_back(static_cast<char>(byte));
    return true;
  };
  try {
    const mcap::Recovery recovery = mcap::recover("file", bytes_of(text), write);
    require(recovery.lost_bytes <= text.size(), "a file loses at most its bytes");
    try {
      require(read(recovered) == recovery.kept.messages, "a recovered file has what was kept");
      const mcap::Reader reader("recovered", bytes_of(recovered));
      require(!reader.ended_early(), "a recovered file is complete");
    } catch (const apps::InputError& damage) {
      throw Broken(damage.what());
    }
  } catch (const apps::InputError&) {
    return;  // not an MCAP file
  }
}

}  // namespace splinecast::fuzz
