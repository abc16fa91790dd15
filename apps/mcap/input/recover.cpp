#include "apps/mcap/input/recover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/mcap/format/checksum.hpp"
#include "apps/mcap/input/chunk_search.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/mcap/input/recovered_file.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {
namespace {

/// Walks over the records of a damaged file.
class Recoverer {
 public:
  Recoverer(const Source& file, Write write)
      : file_(file),
        footer_(footer_of(file.bytes)),
        out_(file, end_, std::move(write), profile()) {}

  Recovery run();

 private:
  [[nodiscard]] std::string profile();
  void read_summary();
  [[nodiscard]] bool is_end(std::uint64_t offset) const;
  [[nodiscard]] bool is_end_of_data(const Record& record);
  [[nodiscard]] bool is_record(std::uint64_t offset) const;
  [[nodiscard]] std::uint64_t take(const Record& record);
  [[nodiscard]] std::uint64_t next_chunk(std::uint64_t offset);
  void check_data();
  void note(const std::string& damage);

  Source file_;
  std::optional<FooterFields> footer_;
  std::uint64_t end_of_data_ = 0;  ///< of a file with a footer
  std::uint64_t known_chunk_ = 0;  ///< where a chunk begins; 0: none is known
  FileEnd end_;
  RecoveredFile out_;
  Recovery recovery_;
};

std::string Recoverer::profile() {
  Records records(file_, std::min(kMagic.size(), file_.bytes.size()));
  Record header;
  if (!records.next(header) || header.opcode != Opcode::header) return "";
  try {
    return std::string(FieldReader(file_, header).string());
  } catch (const InputError&) {
    return "";
  }
}

void Recoverer::note(const std::string& damage) {
  if (recovery_.damages.size() < kMostDamages) {
    recovery_.damages.push_back(damage);
  } else {
    ++recovery_.further_damages;
  }
}

/// Remembers what the summary describes, in case the chunk that describes it is lost.
void Recoverer::read_summary() {
  if (!footer_ || footer_->summary_start == 0) return;
  const std::uint64_t end = file_.bytes.size() - kFileEnd;
  if (footer_->summary_start < kMagic.size() || footer_->summary_start > end) {
    return note(fmt::format("{}: byte {}: the footer says that the summary begins at byte {}",
                            file_.name, end, footer_->summary_start));
  }
  const std::size_t checked = file_.bytes.size() - kMagic.size() - sizeof(std::uint32_t);
  const auto bytes = file_.bytes.first(checked).subspan(footer_->summary_start);
  if (footer_->summary_crc != 0 && footer_->summary_crc != crc32_of(bytes)) {
    return note(fmt::format("{}: byte {}: the summary has a wrong CRC", file_.name,
                            footer_->summary_start));
  }
  Records records(file_, footer_->summary_start);
  for (Record record; records.next(record);) {
    if (record.opcode == Opcode::schema) {
      end_.schemas.emplace(parse_schema(file_, record).id, record);
    }
    if (record.opcode == Opcode::channel) {
      end_.channels.emplace(parse_channel(file_, record).id, record);
    }
    if (record.opcode == Opcode::statistics) {
      end_.messages = parse_statistics(file_, record).messages;
    }
  }
}

/// Finds the end of the data section before the summary or the footer, and compares the checksum.
void Recoverer::check_data() {
  if (!footer_) return;
  end_of_data_ = file_.bytes.size() - kFileEnd;
  constexpr std::uint64_t kDataEnd = kRecordHeader + sizeof(std::uint32_t);
  const std::uint64_t end = footer_->summary_start == 0 ? end_of_data_ : footer_->summary_start;
  if (end < kMagic.size() + kDataEnd || end > end_of_data_) return;
  Record record;
  if (!Records(file_, end - kDataEnd).next(record) || record.opcode != Opcode::data_end ||
      record.size() != kDataEnd) {
    return;
  }
  end_of_data_ = record.offset;
  const auto crc = load<std::uint32_t>(record.content.data());
  if (crc != 0) end_.is_data_right = crc == crc32_of(file_.bytes.first(record.offset));
}

/// Whether the data ends at an offset as it should, or the file is cut off in its last magic.
bool Recoverer::is_end(std::uint64_t offset) const {
  if (footer_) return offset >= end_of_data_;
  const auto rest = file_.bytes.subspan(offset);
  return rest.empty() || is_mcap(rest);
}

/// Whether a file without a footer has nothing to recover after a record.
bool Recoverer::is_end_of_data(const Record& record) {
  if (footer_ || record.opcode != Opcode::data_end || record.offset < known_chunk_) return false;
  const auto chunk = find_chunk(file_.bytes, record.offset, file_.bytes.size());
  known_chunk_ = chunk.value_or(0);  // so that no byte is searched twice
  return !chunk;
}

/// Whether a record begins at an offset, as far as its opcode and its length show, or the file
/// ends.
bool Recoverer::is_record(std::uint64_t offset) const {
  Record record;
  return is_end(offset) || (Records(file_, offset).next(record) && record.opcode > Opcode{} &&
                            record.opcode <= Opcode::data_end);
}

/// The offset of the next chunk, or the end of the file. Counts the bytes until there as lost.
std::uint64_t Recoverer::next_chunk(std::uint64_t offset) {
  const std::uint64_t size = file_.bytes.size();
  const auto next = find_chunk(file_.bytes, std::min(offset + 1, size), size).value_or(size);
  recovery_.lost_bytes += next - offset;
  return next;
}

/// Takes a record. Returns where to continue: after the record, or, if its length is wrong, at the
/// next chunk.
std::uint64_t Recoverer::take(const Record& record) {
  const std::uint64_t end = record.offset + record.size();
  const bool may_hold_chunk = record.opcode == Opcode::attachment ||
                              record.opcode == Opcode::message || record.opcode == Opcode::chunk;
  if (!may_hold_chunk && find_chunk(file_.bytes, record.offset + 1, end)) {
    note(fmt::format("{}: byte {}: a record goes over a chunk", file_.name, record.offset));
    return next_chunk(record.offset);
  }
  try {
    out_.take(record);
    return end;
  } catch (const InputError& damage) {
    note(damage.what());
  }
  if (!is_record(end)) return next_chunk(record.offset);
  recovery_.lost_chunks += record.opcode == Opcode::chunk ? 1 : 0;
  recovery_.lost_bytes += record.size();
  return end;
}

Recovery Recoverer::run() {
  recovery_.was_complete = footer_.has_value();
  check_data();
  try {
    read_summary();
  } catch (const InputError& damage) {
    note(damage.what());
  }
  std::uint64_t offset = std::min(kMagic.size(), file_.bytes.size());
  while (!out_.failed() && !is_end(offset)) {
    Records records(file_, offset);
    Record record;
    if (records.next(record)) {
      if (is_end_of_data(record)) break;
      offset = take(record);
      continue;
    }
    const std::uint64_t next = next_chunk(offset);
    if (footer_ || next < file_.bytes.size()) {
      note(
          fmt::format("{}: byte {}: a record goes beyond the end of the file", file_.name, offset));
    }
    offset = next;
  }
  if (recovery_.damages.empty() && end_.is_data_right == false) {
    note(fmt::format("{}: a record outside of the chunks is damaged: the CRC of all data is wrong",
                     file_.name));
  }
  out_.finish();
  recovery_.kept = out_.statistics();
  if (end_.messages) {
    recovery_.lost_messages = *end_.messages - std::min(*end_.messages, recovery_.kept.messages);
  }
  return std::move(recovery_);
}

}  // namespace

Recovery recover(const std::string& name, std::span<const std::byte> file, Write write) {
  require_mcap();
  const Source source{name, file};
  if (!file.empty() && !is_mcap(file)) source.refuse(0, "this is not an MCAP file");
  return Recoverer(source, std::move(write)).run();
}

}  // namespace splinecast::apps::mcap
