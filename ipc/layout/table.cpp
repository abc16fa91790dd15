#include "ipc/layout/table.hpp"

#include <array>
#include <ostream>
#include <sstream>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/waypoint_items.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::array kParts{
    LayoutPart{"Region", "byte 0 of each region", kRegionFields},
    LayoutPart{"Header", "byte 0 of each region", kHeaderFields},
    LayoutPart{"Control block of a waypoints region", "the control offset of the header",
               kRingControlFields},
    LayoutPart{
        "Ring item",
        "the body of a waypoints region. Item i, counted from 0, is at place i mod capacity.\n"
        "The size of a place is rounded up to a multiple of 64 bytes",
        kItemFields},
    LayoutPart{"Control block of a spline region", "the control offset of the header",
               kBoardControlFields},
    LayoutPart{"Cell of the summary",
               "`summary, cell 0` and `summary, cell 1` of the control block of a spline region",
               kSummaryFields},
    LayoutPart{"Body of a spline region",
               "the body of a spline region.\n"
               "The slots follow the times, at the next multiple of 4096 bytes",
               kBodyFields},
    LayoutPart{"Cell of a knot",
               "a slot (cell 0, then cell 1).\n"
               "The size of each part of a slot is rounded up to a multiple of 64 bytes",
               kCellFields},
    LayoutPart{"Node of a knot", "the end of the cells of a slot (node 0, then node 1)",
               kNodeFields},
    LayoutPart{"Beside a cell",
               "the end of the nodes of a slot (the part of cell 0, then that of cell 1)",
               kBesideFields},
    LayoutPart{"Row of a knot", "the end of the parts beside the cells (row 0, then row 1)",
               kRowFields},
    LayoutPart{"Control block of a commander region", "the control offset of the header",
               kCommanderControlFields},
    LayoutPart{"Commander of a time law",
               "the end of the slots of a law's board, at the next multiple of 4096 bytes.\n"
               "A table has 16 of them; there are two, one for each cell of the summary",
               kCommanderFields},
    LayoutPart{"Control block of a stopper region", "the control offset of the header",
               kStopperControlFields},
    LayoutPart{"Stopper of a stream",
               "`stoppers` of the body of a spline region.\n"
               "A table has 16 of them; there are two, one for each cell of the summary",
               kStopperFields}};

class Fnv {
 public:
  void add(std::uint64_t value) noexcept {
    for (unsigned shift = 0; shift < 64; shift += 8) add_byte(value >> shift & 0xff);
  }
  void add(std::string_view text) noexcept {
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
    add(text.size());
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  void add_byte(std::uint64_t byte) noexcept { hash_ = (hash_ ^ byte) * 0x100000001b3; }
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Words as bytes: `16`, `8·D`, `16 + 8·D`.
std::string bytes_text(const Extent& extent) {
  std::string words = std::to_string(extent.words * sizeof(Word));
  if (extent.per_dimension == 0) return words;
  std::string text = extent.words == 0 ? "" : words + " + ";
  return text.append(std::to_string(extent.per_dimension * sizeof(Word))).append("·D");
}

const char* writer_text(FieldWriter writer) noexcept {
  return writer == FieldWriter::maker ? "maker" : "owner";
}

/// Writes a field as a row of its table; each further line of its meaning is a row of its own.
void write_rows(std::ostream& page, const Field& field) {
  if (field.writer == FieldWriter::padding) return;
  const bool is_open = field.size == Extent{};
  page << "| " << bytes_text(field.offset) << " | " << (is_open ? "" : bytes_text(field.size))
       << " | " << field.name << " | " << writer_text(field.writer) << " | ";
  for (const char c : field.meaning) {
    if (c == '\n') {
      page << " |\n| | | | | ";
    } else {
      page << c;
    }
  }
  page << " |\n";
}

}  // namespace

std::span<const LayoutPart> layout_parts() noexcept { return kParts; }

std::uint64_t layout_hash(std::span<const LayoutPart> parts) noexcept {
  Fnv hash;
  for (const LayoutPart& part : parts) {
    hash.add(part.name);
    for (const Field& field : part.fields) {
      hash.add(field.name);
      for (const Extent& extent : {field.offset, field.size}) {
        hash.add(extent.words);
        hash.add(extent.per_dimension);
      }
      hash.add(static_cast<std::uint64_t>(field.writer));
    }
  }
  return hash.value();
}

std::uint64_t layout_hash() noexcept {
  static const std::uint64_t hash = layout_hash(kParts);
  return hash;
}

std::string layout_page() {
  std::ostringstream page;
  page << "# Fields of the shared memory\n\nEvery field of both regions of a stream, and of a "
          "commander of a time law\nand of a stopper of a stream, layout version "
       << kLayoutVersion
       << ": place, size, writer and meaning.\nFor engineers who read a hex dump or write a reader "
          "in another language;\n[The shared memory of a stream](layout.md) explains how the parts "
          "work together.\n\nGenerated from the tables in [`ipc/layout`](../ipc/layout), which the "
          "code uses; a test compares.\nLayout hash: `"
       << std::hex << layout_hash() << std::dec
       << "`.\n\n- Offsets and sizes are in bytes; offsets count from the beginning of the part.\n"
          "- Numbers are little-endian 64-bit words unless stated otherwise; times are signed "
          "nanoseconds;\n  doubles are their IEEE 754 bits.\n- D is the number of dimensions.\n"
          "- *maker*: written by the process that creates the region, before the region gets its "
          "name, and never again.\n- *owner*: written by the process that holds the lock of the "
          "region.\n";
  for (const LayoutPart& part : kParts) {
    page << "\n## " << part.name << "\n\nBegins at: " << part.place
         << ".\n\n| offset | bytes | field | written by | meaning |\n|---|---|---|---|---|\n";
    for (const Field& field : part.fields) write_rows(page, field);
  }
  return page.str();
}

}  // namespace splinecast::ipc
