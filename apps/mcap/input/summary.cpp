#include <fmt/format.h>

#include "apps/mcap/format/checksum.hpp"
#include "apps/mcap/input/reader.hpp"

namespace splinecast::apps::mcap {

/// Reads schemas, channels, statistics and metadata of a complete file, before any message.
void Reader::read_summary() {
  const std::uint64_t end = file_.bytes.size() - kFooter;
  if (footer_->summary_start < kMagic.size() || footer_->summary_start > end) {
    file_.refuse(end, fmt::format("the footer says that the summary begins at byte {}",
                                  footer_->summary_start));
  }
  const std::size_t checked = file_.bytes.size() - sizeof(std::uint32_t) - footer_->summary_start;
  const std::uint32_t crc = footer_->summary_crc == 0
                                ? 0
                                : crc32_of(file_.bytes.subspan(footer_->summary_start, checked));
  if (crc != footer_->summary_crc) {
    file_.refuse(footer_->summary_start,
                 fmt::format("the summary has the CRC {:#010x}, but {:#010x} is recorded", crc,
                             footer_->summary_crc));
  }
  const Source summary{file_.name, file_.bytes.first(end)};
  Records records(summary, footer_->summary_start);
  Record record;
  while (records.next(record)) read_summary_record(summary, record);
  if (!records.is_at_end()) {
    summary.refuse(records.offset(), "a record goes beyond the end of the summary");
  }
}

void Reader::read_summary_record(const Source& summary, const Record& record) {
  if (record.opcode == Opcode::schema) channels_.add_schema(summary, record, memory_);
  if (record.opcode == Opcode::channel) channels_.add_channel(summary, record, memory_);
  if (record.opcode == Opcode::statistics) statistics_ = parse_statistics(summary, record);
  if (record.opcode == Opcode::metadata_index) read_indexed_metadata(summary, record);
}

/// Reads the metadata record of an index. Ignores an index with a wrong offset, such as those that
/// @mcap/core 2.2 writes into files without chunks: next() will meet the record.
void Reader::read_indexed_metadata(const Source& summary, const Record& record) {
  const auto offset = FieldReader(summary, record).number<std::uint64_t>();
  Record metadata;
  if (offset <= summary.bytes.size() && Records(summary, offset).next(metadata) &&
      metadata.opcode == Opcode::metadata) {
    add_metadata(metadata);
  }
}

}  // namespace splinecast::apps::mcap
