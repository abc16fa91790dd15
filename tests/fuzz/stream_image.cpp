#include "tests/fuzz/stream_image.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <limits>

#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/publication.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::fuzz {
namespace {

using ipc::Word;

/// Takes numbers from the front of bytes; zeros after their end.
class Source {
 public:
  explicit Source(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count) {
    const auto taken = bytes_.first(std::min(count, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  template <typename Number>
  [[nodiscard]] Number number() {
    Number value = 0;
    const auto taken = take(sizeof value);
    std::memcpy(&value, taken.data(), taken.size());
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

template <typename Number>
void put(std::vector<std::uint8_t>& out, Number value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

/// Calls `visit(begin, end)` for each range of words that are not 0. A single 0 does not end a
/// range.
void for_each_stretch(std::span<const Word> words, const auto& visit) {
  std::size_t i = 0;
  while (i < words.size()) {
    if (words[i] == 0) {
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < words.size() &&
           (words[end] != 0 || (end + 1 < words.size() && words[end + 1] != 0))) {
      ++end;
    }
    visit(i, end);
    i = end;
  }
}

std::size_t below(std::size_t limit, std::mt19937_64& random) { return random() % limit; }

/// Special values and values at the limits of their ranges.
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<double, 12> kDoubles{
    0,     -0.0,   1,      -1,    1e100,     -1e100,
    1e300, 1e-300, 1e-320, 1e200, kInfinity, std::numeric_limits<double>::quiet_NaN()};
constexpr std::array<Word, 16> kWords{0,
                                      1,
                                      2,
                                      3,
                                      4,
                                      6,
                                      64,
                                      65,
                                      1U << 10U,
                                      1ULL << 32U,
                                      1ULL << 61U,
                                      1ULL << 62U,
                                      1ULL << 63U,
                                      (1ULL << 63U) - 1,
                                      std::numeric_limits<Word>::max(),
                                      std::numeric_limits<Word>::max() - 1};

Word interesting(std::mt19937_64& random, Word before, std::span<const Word> region) {
  switch (below(9, random)) {
    case 0:
      return kWords[below(kWords.size(), random)];
    case 1:
      return std::bit_cast<Word>(kDoubles[below(kDoubles.size(), random)]);
    case 2:
      return before ^ Word { 1 } << below(64, random);
    case 3:
      return before + 1 - below(3, random);
    case 4:
      return before + below(256, random) - 128;
    case 5:
      return random();
    case 6:
      return region[below(region.size(), random)];
    case 7:
      return Word{0} - before;
    default:
      return before ^ (below(256, random) << (8 * below(8, random)));
  }
}

/// A range of words in a region, from `begin` to before `end`.
struct Range {
  std::size_t begin;
  std::size_t end;
};

constexpr std::size_t kWord = sizeof(Word);
constexpr Range kFixed{0, ipc::word_of(ipc::kHeaderFields, "start value")};
constexpr Range kPerDimension{kFixed.end, ipc::kHeaderWords};
constexpr std::size_t kBody = ipc::kBodyOffset / kWord;

/// `count` words of the control block from `first` on, at the offset in the header.
Range control_of(std::span<const Word> region, std::size_t first, std::size_t count) {
  constexpr std::size_t kOffset = ipc::word_of(ipc::kHeaderFields, "control offset");
  const std::size_t begin = region[kOffset] % ipc::kBodyOffset / kWord + first;
  return {begin, begin + count};
}

/// The layout of a board's image; without slots if its header is invalid.
ipc::BoardLayout layout_of(std::span<const Word> region) {
  if (region.size() < kBody) return {};
  const ipc::RegionHeader header = ipc::decode_header(region);
  const bool has_size = header.dimensions >= 1 && header.dimensions <= kMaxDimensions &&
                        header.capacity >= 1 && header.capacity <= kMaxWords;
  if (!has_size) return {};
  const auto layout = ipc::BoardLayout::of(header.dimensions, header.capacity, header.control,
                                           ipc::smooths(header), header.is_law != 0);
  return layout.bytes > region.size_bytes() ? ipc::BoardLayout{} : layout;
}

/// A part of a knot's slot: a cell with its tag, a node, the words beside a cell, or a row.
Range part_of_slot(const ipc::BoardLayout& layout, std::mt19937_64& random) {
  const std::size_t slot = layout.slots + below(layout.capacity, random) * layout.stride;
  const std::size_t which = below(2, random);
  const auto part = [&](std::size_t offset, std::size_t bytes) {
    const std::size_t begin = (slot + offset + which * bytes) / kWord;
    return Range{begin, begin + bytes / kWord};
  };
  switch (below(4, random)) {
    case 0:
      return part(0, layout.cell);
    case 1:
      return part(layout.nodes, layout.node);
    case 2:
      return part(layout.beside, layout.beside_bytes);
    default:
      return part(layout.rows, layout.row);
  }
}

/// The part of a region in which a mutation changes a word. Most words of a header are in its first
/// 256 bytes.
Range part_of(std::span<const Word> region, bool is_board, std::mt19937_64& random) {
  const ipc::BoardLayout board = is_board ? layout_of(region) : ipc::BoardLayout{};
  const bool has_commanders = board.capacity > 0 && board.commanders > 0;
  switch (below(has_commanders ? 14 : board.capacity > 0 ? 10 : 5, random)) {
    case 0:
      return kFixed;
    case 1:
      return kPerDimension;
    case 2:
      return control_of(region, 0, ipc::kRingControlWords);
    case 3:
      return {kBody, region.size()};
    case 4:
      return {0, region.size()};
    case 5:
      return control_of(region, ipc::kSummarySlot, 2 * ipc::kSummaryWords);
    case 6:
      return control_of(region, ipc::kChanges, ipc::kChangesKept);
    case 7:
      return {board.times / kWord, board.times / kWord + board.capacity};
    case 8:
    case 9:
      return part_of_slot(board, random);
    default:
      return {board.commanders / kWord, board.commanders / kWord + 2 * ipc::kCommanderTableWords};
  }
}

/// A wrong tag for this place: with another revision near the committed one, with another form or
/// note, or of the other node or row.
Word other_tag(Word tag, Word committed, std::mt19937_64& random) {
  constexpr unsigned kNoteBits = ipc::kTagRevisionShift;
  constexpr Word kNote = (Word{1} << kNoteBits) - 1;
  switch (below(7, random)) {
    case 0:
      return (committed + 2 - below(5, random)) << kNoteBits | (tag & kNote);
    case 1:
      return tag ^ Word { 1 } << below(kNoteBits, random);
    case 2:
      return tag ^ below(16, random) << 1U;  // the form
    case 3:
      return tag ^ (random() & kNote);
    case 4:
      return ipc::kRetiredTag;
    case 5:
      return tag & kNote;
    default:
      return tag + (Word{1} << kNoteBits);
  }
}

/// Changes a tag of the summary or of a knot.
void mutate_tag(std::vector<Word>& board, std::mt19937_64& random) {
  const ipc::BoardLayout layout = layout_of(board);
  if (layout.capacity == 0) return;
  const Range control = control_of(board, 0, ipc::kBoardControlWords);
  const std::size_t cell = below(2, random);
  std::size_t at = control.begin + ipc::kSummarySlot + cell * ipc::kSummaryWords;
  if (below(8, random) != 0) {
    const std::size_t slot = below(layout.capacity, random);
    at = (layout.slots + slot * layout.stride + cell * layout.cell) / kWord;
  }
  if (at < board.size()) board[at] = other_tag(board[at], board[control.begin], random);
}

/// A word in a part. Prefers words that are not 0, because most words of a part are 0.
std::size_t word_in(std::span<const Word> region, const Range& part, std::mt19937_64& random) {
  const std::size_t size = part.end - part.begin;
  const std::size_t begin = below(size, random);
  if (below(8, random) == 0) return part.begin + begin;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t at = part.begin + (begin + i) % size;
    if (region[at] != 0) return at;
  }
  return part.begin + begin;
}

void mutate_region(std::vector<Word>& region, bool is_board, std::mt19937_64& random) {
  if (below(200, random) == 0) region.resize(below(kMaxWords, random));  // another file size
  if (region.empty()) return;
  Range part{0, region.size()};
  if (region.size() > kBody) part = part_of(region, is_board, random);
  part.end = std::min(part.end, region.size());
  const std::size_t at = word_in(region, part, random);
  const std::size_t run = below(16, random) == 0 ? below(64, random) : 1;
  const Word value = interesting(random, region[at], region);
  for (std::size_t i = at; i < std::min(at + run, region.size()); ++i) region[i] = value;
}

void mutate_script(std::vector<std::uint8_t>& script, std::mt19937_64& random) {
  constexpr std::size_t kLongest = 512;
  const std::size_t at = below(script.size() + 1, random);
  const auto where = script.begin() + static_cast<std::ptrdiff_t>(at);
  const auto byte = static_cast<std::uint8_t>(random());
  if (at == script.size() || below(3, random) == 0) {
    if (script.size() < kLongest) script.insert(where, byte);
  } else if (below(3, random) == 0) {
    script.erase(where);
  } else {
    script[at] = byte;
  }
}

/// A word of the concatenation of the regions.
Word& word_of(StreamImage& image, std::size_t i) {
  if (i < image.ring.size()) return image.ring[i];
  i -= image.ring.size();
  return i < image.board.size() ? image.board[i] : image.commander[i - image.board.size()];
}

}  // namespace

StreamImage decode(std::span<const std::uint8_t> bytes) {
  Source source(bytes);
  const auto script = source.number<std::uint32_t>();
  const auto ring = source.number<std::uint32_t>();
  const auto board = source.number<std::uint32_t>();
  const auto commander = source.number<std::uint32_t>();
  StreamImage image;
  image.ring.resize(ring % (kMaxWords + 1));
  image.board.resize(board % (kMaxWords + 1));
  image.commander.resize(commander % (kMaxWords + 1));
  const auto commands = source.take(script);
  image.script.assign(commands.begin(), commands.end());
  const std::size_t all = image.ring.size() + image.board.size() + image.commander.size();
  while (!source.empty() && all > 0) {
    const std::size_t at = source.number<std::uint32_t>() % all;
    const std::size_t count = std::min<std::size_t>(source.number<std::uint32_t>(), all - at);
    for (std::size_t i = at; i < at + count && !source.empty(); ++i) {
      word_of(image, i) = source.number<Word>();
    }
  }
  return image;
}

std::vector<std::uint8_t> encode(const StreamImage& image) {
  std::vector<std::uint8_t> out;
  const std::array sizes{image.script.size(), image.ring.size(), image.board.size(),
                         image.commander.size()};
  for (const std::size_t size : sizes) put(out, static_cast<std::uint32_t>(size));
  std::ranges::copy(image.script, std::back_inserter(out));
  std::size_t offset = 0;
  for (const auto* region : {&image.ring, &image.board, &image.commander}) {
    for_each_stretch(*region, [&](std::size_t begin, std::size_t end) {
      put(out, static_cast<std::uint32_t>(offset + begin));
      put(out, static_cast<std::uint32_t>(end - begin));
      for (std::size_t i = begin; i < end; ++i) put(out, (*region)[i]);
    });
    offset += region->size();
  }
  return out;
}

void mutate(StreamImage& image, std::mt19937_64& random) {
  for (std::size_t count = 1 + below(4, random); count > 0; --count) {
    switch (below(image.commander.empty() ? 5 : 8, random)) {
      case 0:
        mutate_script(image.script, random);
        break;
      case 1:
        mutate_region(image.ring, false, random);
        break;
      case 2:
        mutate_tag(image.board, random);
        break;
      case 3:
      case 4:
        mutate_region(image.board, true, random);
        break;
      default:
        mutate_region(image.commander, false, random);
    }
  }
}

}  // namespace splinecast::fuzz
