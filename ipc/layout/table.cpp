#include "ipc/layout/table.hpp"

#include <array>
#include <sstream>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/mark.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/waypoint_items.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::array kParts{
    LayoutPart{"Region", "byte 0 of both regions", kRegionFields},
    LayoutPart{"Header", "byte 0 of both regions", kHeaderFields},
    LayoutPart{"Control block of a waypoints region", "the control offset of the header",
               kRingControlFields},
    LayoutPart{"Ring item",
               "the body of a waypoints region: item i, counted from 0, in place i mod "
               "capacity; places are rounded up to 64 bytes",
               kItemFields},
    LayoutPart{"Control block of a spline region", "the control offset of the header",
               kBoardControlFields},
    LayoutPart{"Cell of the summary", "two in the control block of a spline region",
               kSummaryFields},
    LayoutPart{"Body of a spline region",
               "the body; slots follow the times, at the next multiple of "
               "4096 bytes",
               kBodyFields},
    LayoutPart{"Cell of a knot", "a slot, twice; as all parts of a slot rounded up to 64 bytes",
               kCellFields},
    LayoutPart{"Node of a knot", "after the cells of a slot, twice", kNodeFields},
    LayoutPart{"Beside a cell", "after the nodes of a slot, twice: of cell 0 and of cell 1",
               kBesideFields},
    LayoutPart{"Row of a knot", "after what is beside the cells, twice", kRowFields}};

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
  page << "# The bytes of a stream's regions, layout version " << kLayoutVersion
       << "\n\nMade from the tables of `ipc/layout`, by which the code reads and writes them; a "
          "test "
          "compares. Layout hash: `"
       << std::hex << layout_hash() << std::dec
       << "`.\n\nOffsets and sizes are in bytes, from where the part begins; all numbers are "
          "little-endian 64-bit words\nunless said otherwise, times signed nanoseconds, doubles "
          "their IEEE 754 bits; D is the number of dimensions.\n*maker*: written before the region "
          "gets its name, and never again. *owner*: written by the process that holds\nthe "
          "region's lock.\n";
  for (const LayoutPart& part : kParts) {
    page << "\n## " << part.name << "\n\nBegins at: " << part.place
         << ".\n\n| offset | bytes | field | written by | |\n|---|---|---|---|---|\n";
    for (const Field& field : part.fields) {
      if (field.writer == FieldWriter::padding) continue;
      const bool is_open = field.size == Extent{};
      page << "| " << bytes_text(field.offset) << " | " << (is_open ? "" : bytes_text(field.size))
           << " | " << field.name << " | " << writer_text(field.writer) << " | " << field.meaning
           << " |\n";
    }
  }
  return page.str();
}

}  // namespace splinecast::ipc
