#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "apps/mcap/format/record.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/mcap/input/recover.hpp"
#include "apps/mcap/output/writer.hpp"

namespace splinecast::testing {

/// A message that was written or read.
struct KeptMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  std::int64_t log_time = 0;
  std::int64_t publish_time = 0;
  std::string data;
  bool operator==(const KeptMessage&) const = default;
};

/// Writes a file of MCAP into memory.
class MemoryFileWriter {
 public:
  explicit MemoryFileWriter(const apps::mcap::WriterOptions& options)
      : writer([this](std::span<const std::byte> bytes) { return take(bytes); }, options) {}

  std::string file;
  apps::mcap::Writer writer;

 private:
  bool take(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) file.push_back(static_cast<char>(byte));
    return true;
  }
};

/// A small file with two channels, three chunks and metadata.
struct SmallRecording {
  explicit SmallRecording(apps::mcap::Compression compression, bool is_finished = true);
  std::string file;
  std::vector<KeptMessage> messages;
};

/// Where the whole records of a kind end in a file, outside of chunks.
std::vector<std::size_t> ends_of(const std::string& file, apps::mcap::Opcode opcode);

std::span<const std::byte> bytes_of(const std::string& file);

/// All messages of a file. Throws as apps::mcap::Reader does.
std::vector<KeptMessage> messages_of(const std::string& file);
std::vector<KeptMessage> rest_of(apps::mcap::Reader& reader);

/// A file that recover() has written, and its report.
struct Recovered {
  std::string file;
  apps::mcap::Recovery report;
};
Recovered recover_text(const std::string& file);

}  // namespace splinecast::testing
