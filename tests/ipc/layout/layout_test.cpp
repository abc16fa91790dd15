#include "ipc/layout/header.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

RegionHeader ring_header() {
  RegionHeader header = make_header({.dimensions = 2}, 77);
  header.kind = static_cast<std::uint64_t>(RegionKind::waypoints);
  header.capacity = 8;
  const auto layout = RingLayout::of(2, 8, header.control);
  header.stride = layout.stride;
  header.region_bytes = layout.bytes;
  return header;
}

TEST(Layout, PartsOfARegionFollowEachOtherAlignedAndWithinIt) {
  for (const std::size_t dimensions : {1U, 3U, 7U, 64U}) {
    const auto ring = RingLayout::of(dimensions, 1024, kHeaderBytes);
    EXPECT_GE(ring.items, ring.control + kRingControlWords * sizeof(Word));
    EXPECT_EQ(ring.stride % kCacheLine, 0U);
    EXPECT_LE(ring.items + 1024 * ring.stride, ring.bytes);
    for (const bool smooths : {false, true}) {
      const auto board = BoardLayout::of(dimensions, 4096, kHeaderBytes, smooths);
      EXPECT_GE(board.refusals, board.control + kBoardControlWords * sizeof(Word));
      EXPECT_EQ(board.excesses, board.refusals + kRefusalsKept * sizeof(Word));
      EXPECT_EQ(board.times, board.excesses + kExcessesKept * kExcessWords * sizeof(Word));
      EXPECT_GE(board.slots, board.times + 4096 * sizeof(Word));
      EXPECT_EQ(board.slots % kPage, 0U);
      for (const std::size_t bytes : {board.cell, board.node, board.beside_bytes, board.row}) {
        EXPECT_EQ(bytes % kCacheLine, 0U);
      }
      EXPECT_EQ(board.nodes, 2 * board.cell);
      EXPECT_EQ(board.beside, board.nodes + 2 * board.node);
      EXPECT_EQ(board.rows, board.beside + 2 * board.beside_bytes);
      EXPECT_EQ(board.stride, board.rows + 2 * board.row);
      EXPECT_LE(board.slots + 4096 * board.stride, board.bytes);
    }
  }
}

TEST(Layout, TheRegionsOfSevenDimensionsAreAsLargeAsTheReadmeSays) {
  const std::string said =
      "| board of 4,096 knots, ring of 1,024 waypoints | 2,199,552 and 212,992 bytes of shared";
  EXPECT_EQ(BoardLayout::of(7, 4096, kHeaderBytes, false).bytes, 2'199'552U);
  EXPECT_EQ(RingLayout::of(7, 1024, kHeaderBytes).bytes, 212'992U);
  std::ifstream file(SPLINECAST_SOURCE "/README.md");
  std::ostringstream readme;
  readme << file.rdbuf();
  EXPECT_NE(readme.str().find(said), std::string::npos);
  const std::string positions = std::to_string(kControlPositions);
  EXPECT_NE(readme.str().find("at one of " + positions + " offsets"), std::string::npos);
}

TEST(Layout, PartsOfASlotOfSevenDimensionsAreACacheLineEach) {
  const auto board = BoardLayout::of(7, 4096, kHeaderBytes, false);
  EXPECT_EQ(board.cell, kCacheLine);
  EXPECT_EQ(board.node, kCacheLine);
  EXPECT_EQ(board.beside_bytes, kCacheLine);
  EXPECT_EQ(board.row, kCacheLine);
  EXPECT_EQ(board.stride, 8 * kCacheLine);
}

TEST(Layout, WhatDifferentProcessesWriteOrPollLiesTwoCacheLinesApart) {
  const auto line = [](std::size_t word) { return word * sizeof(Word) / kSeparation; };
  EXPECT_NE(line(kHead), line(kProducerCounters));
  for (const std::size_t word : {kTail, kSleeping, kHeadSlot}) {
    EXPECT_NE(line(word), line(kRevision)) << word;
  }
  EXPECT_NE(line(kTail), line(kSleeping));
  EXPECT_NE(line(kSleeping), line(kHeadSlot));
}

TEST(Layout, TheControlBlockOfEveryStreamLiesInItsArea) {
  std::set<std::uint64_t> places;
  for (std::uint64_t id = 1; id < 200; ++id) {
    const auto header = make_header({.dimensions = 1}, id);
    EXPECT_GE(header.control, kHeaderBytes);
    EXPECT_EQ(header.control, kHeaderBytes + kSeparation * (id % kControlPositions));
    EXPECT_LE(header.control + kBoardControlWords * sizeof(Word), kBodyOffset);
    places.insert(header.control);
  }
  EXPECT_EQ(places.size(), kControlPositions);
}

/// Fields whose order and sizes a part's table gives lie one behind the other.
TEST(Layout, TheFieldsOfEachPartFollowEachOtherAndHaveNamesOfTheirOwn) {
  for (const LayoutPart& part : layout_parts()) {
    Extent offset;
    std::set<std::string_view> names;
    for (const Field& field : part.fields) {
      EXPECT_EQ(field.offset, offset) << part.name << ": " << field.name;
      offset = offset + field.size;
      if (field.writer == FieldWriter::padding) continue;
      EXPECT_TRUE(names.insert(field.name).second) << part.name << ": " << field.name;
      EXPECT_FALSE(field.meaning.empty()) << part.name << ": " << field.name;
    }
  }
}

/// The parts of the layout with tables that can be changed.
struct Tables {
  std::vector<std::vector<Field>> fields;
  std::vector<LayoutPart> parts;

  Tables() {
    for (const LayoutPart& part : layout_parts()) {
      fields.emplace_back(part.fields.begin(), part.fields.end());
      parts.push_back(part);
    }
  }
  [[nodiscard]] std::uint64_t hash() {
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i].fields = fields[i];
    return layout_hash(parts);
  }
};

TEST(LayoutHash, IsThatOfTheTables) { EXPECT_EQ(Tables().hash(), layout_hash()); }

TEST(LayoutHash, ChangesWithEachPropertyOfEachField) {
  using Change = std::pair<const char*, void (*)(Field&)>;
  constexpr std::array kWays{
      Change{"name", [](Field& f) { f.name = "another"; }},
      Change{"offset", [](Field& f) { ++f.offset.words; }},
      Change{"offset per dimension", [](Field& f) { ++f.offset.per_dimension; }},
      Change{"size", [](Field& f) { ++f.size.words; }},
      Change{"size per dimension", [](Field& f) { ++f.size.per_dimension; }},
      Change{"writer", [](Field& f) {
               f.writer = f.writer == FieldWriter::owner ? FieldWriter::maker : FieldWriter::owner;
             }}};
  std::set<std::uint64_t> hashes{layout_hash()};
  std::size_t changes = 0;
  Tables tables;
  for (std::size_t part = 0; part < tables.fields.size(); ++part) {
    for (Field& field : tables.fields[part]) {
      const Field before = field;
      for (const auto& [what, change] : kWays) {
        change(field);
        EXPECT_TRUE(hashes.insert(tables.hash()).second)
            << what << " of " << tables.parts[part].name << ": " << before.name;
        field = before;
        ++changes;
      }
    }
  }
  EXPECT_EQ(hashes.size(), changes + 1);
}

TEST(LayoutHash, ChangesWithRowsAddedTakenAwayAndExchanged) {
  std::set<std::uint64_t> hashes{layout_hash()};
  std::size_t changes = 0;
  const auto expect_other = [&](Tables& tables, const std::string& what) {
    EXPECT_TRUE(hashes.insert(tables.hash()).second) << what;
    ++changes;
  };
  const std::size_t parts = Tables().parts.size();
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t rows = Tables().fields[part].size();
    const std::string name(Tables().parts[part].name);
    for (std::size_t row = 0; row < rows; ++row) {
      const auto at = static_cast<std::ptrdiff_t>(row);
      Tables taken;
      taken.fields[part].erase(taken.fields[part].begin() + at);
      expect_other(taken, name + " without row " + std::to_string(row));
      Tables added;
      added.fields[part].insert(added.fields[part].begin() + at,
                                {"another", {}, {.words = 1}, FieldWriter::owner, ""});
      expect_other(added, name + " with a row before " + std::to_string(row));
      if (row == 0) continue;
      Tables exchanged;
      std::swap(exchanged.fields[part][row - 1], exchanged.fields[part][row]);
      expect_other(exchanged, name + " with row " + std::to_string(row) + " one earlier");
    }
  }
  EXPECT_EQ(hashes.size(), changes + 1);
}

TEST(LayoutHash, ChangesWithPartsExchangedOrRenamed) {
  Tables tables;
  std::swap(tables.parts[0], tables.parts[1]);
  std::swap(tables.fields[0], tables.fields[1]);
  EXPECT_NE(tables.hash(), layout_hash());
  Tables renamed;
  renamed.parts[3].name = "another";
  EXPECT_NE(renamed.hash(), layout_hash());
}

TEST(LayoutHash, DoesNotChangeWithMeanings) {
  Tables tables;
  tables.fields[1][3].meaning = "otherwise";
  EXPECT_EQ(tables.hash(), layout_hash());
}

/// Fills the bytes of one member with what no other member has, and expects them, and nothing else,
/// at the words that its row says; and back.
template <typename Struct, auto Member>
void expect_member_at_its_place(const auto& rows, std::span<const Field> fields,
                                const MemberRow<Member>& row) {
  using Value = typename detail::MemberOf<Member>::type;
  constexpr std::size_t kWords = detail::MemberOf<Member>::words;
  SCOPED_TRACE(row.name);
  Extent offset;
  for (const Field& field : fields) {
    if (field.name == row.name) offset = field.offset;
  }
  Struct from{};
  std::vector<Word> words(size_of(fields).words);
  encode(rows, from, words.data());
  const std::vector<Word> empty = words;
  std::vector<Word> wanted(kWords);
  if constexpr (std::is_same_v<Value, bool>) {
    from.*Member = !(from.*Member);
    wanted[0] = from.*Member ? 1 : 0;
  } else {
    for (std::size_t i = 0; i < kWords; ++i) wanted[i] = 0x0102030405060708 * (i + 1);
    std::memcpy(static_cast<void*>(&(from.*Member)), wanted.data(), sizeof(Value));
  }
  encode(rows, from, words.data());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool is_own = i >= offset.words && i < offset.words + kWords;
    EXPECT_EQ(words[i], is_own ? wanted[i - offset.words] : empty[i]) << i;
  }
  Struct back{};
  decode(rows, words.data(), back);
  EXPECT_EQ(std::memcmp(static_cast<const void*>(&(back.*Member)),
                        static_cast<const void*>(&(from.*Member)), sizeof(Value)),
            0);
}

template <typename Struct>
void expect_member_at_its_place(const auto& /*rows*/, std::span<const Field> /*fields*/,
                                const FieldRow& /*row*/) {}

template <typename Struct, typename Rows>
void expect_members_at_their_places(const Rows& rows, std::span<const Field> fields) {
  std::apply(
      [&](const auto&... row) { (expect_member_at_its_place<Struct>(rows, fields, row), ...); },
      rows);
}

TEST(LayoutTable, EveryMemberOfTheHeaderComesBackFromTheWordsThatItsRowNames) {
  expect_members_at_their_places<RegionHeader>(kHeaderRows, kHeaderFields);
}

TEST(LayoutTable, EveryMemberOfTheHeadComesBackFromTheWordsThatItsRowNames) {
  expect_members_at_their_places<Head>(kHeadRows, kHeadFields);
}

/// A member without a row would be lost on the way through shared memory.
TEST(LayoutTable, TheRowsOfHeaderAndHeadNameAllTheirMembers) {
  const auto count = [](const auto&... row) {
    const auto bytes = []<typename Row>(const Row& each) -> std::size_t {
      if constexpr (std::is_same_v<Row, FieldRow>) {
        return 0;
      } else {
        return each.name.empty() ? 0 : detail::as_row(each).size.words * sizeof(Word);
      }
    };
    return (bytes(row) + ...);
  };
  EXPECT_EQ(std::apply(count, kHeaderRows), sizeof(RegionHeader));
  // Three members are not of the revision alone and lie elsewhere; two flags share a word here.
  constexpr std::size_t kElsewhere =
      sizeof(Head::revision) + sizeof(Head::settled_until) + sizeof(Head::changed_from);
  EXPECT_EQ(std::apply(count, kHeadRows) + kElsewhere, sizeof(Head) + sizeof(Word));
}

constexpr const char* kPagePath = SPLINECAST_SOURCE "/ipc/layout.md";

/// With SPLINECAST_WRITE_LAYOUT set, the page is written instead.
TEST(LayoutPage, IsWhatTheTablesSay) {
  if (std::getenv("SPLINECAST_WRITE_LAYOUT") != nullptr) {
    std::ofstream(kPagePath) << layout_page();
    GTEST_SKIP() << kPagePath << " has been written";
  }
  std::ifstream file(kPagePath);
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_EQ(page.str(), layout_page())
      << kPagePath << " is out of date; write it again with\n  SPLINECAST_WRITE_LAYOUT=1 "
      << "splinecast_tests --gtest_filter=LayoutPage.*";
}

TEST(LayoutPage, SaysWhichVersionItIsOf) {
  const std::string version = std::to_string(kLayoutVersion);
  EXPECT_NE(layout_page().find("layout version " + version), std::string::npos);
  EXPECT_NE(layout_page().find("32 bits each: " + version + " and"), std::string::npos);
}

TEST(LayoutPage, SaysHowManyPositionsTheControlBlockMayHave) {
  const std::string positions = std::to_string(kControlPositions);
  EXPECT_NE(layout_page().find("(stream id mod " + positions + ")"), std::string::npos);
}

TEST(Layout, AHeaderThatSaysSomethingElseIsRefusedWithTheValue) {
  const RegionHeader good = ring_header();
  EXPECT_NO_THROW(checked_ring_layout(good, good.region_bytes));
  const std::vector<std::pair<std::string, std::function<void(RegionHeader&)>>> cases{
      {"magic number 1", [](RegionHeader& h) { h.magic = 1; }},
      {"byte order 67305985", [](RegionHeader& h) { h.mark.byte_order = 0x04030201; }},
      {"byte order 5", [](RegionHeader& h) { h.mark.byte_order = 5; }},
      {"layout version 9", [](RegionHeader& h) { h.mark.version = 9; }},
      {"with hash 5", [](RegionHeader& h) { h.layout_hash = 5; }},
      {"kind 2", [](RegionHeader& h) { h.kind = 2; }},
      {"dimensions 0", [](RegionHeader& h) { h.dimensions = 0; }},
      {"dimensions 65", [](RegionHeader& h) { h.dimensions = 65; }},
      {"capacity 9", [](RegionHeader& h) { h.capacity = 9; }},
      {"capacity 1", [](RegionHeader& h) { h.capacity = 1; }},
      {"capacity 1152921504606846976", [](RegionHeader& h) { h.capacity = Word{1} << 60U; }},
      {"control offset 64", [](RegionHeader& h) { h.control = 64; }},
      {"control offset 8200", [](RegionHeader& h) { h.control = kHeaderBytes + 8; }},
      {"control offset 14720", [](RegionHeader& h) { h.control = kHeaderBytes + 51 * 128; }},
      {"clock 7", [](RegionHeader& h) { h.clock = 7; }},
      {"item size 8", [](RegionHeader& h) { h.stride = 8; }},
      {"kind of dimension 4", [](RegionHeader& h) { h.dimension_kind[1] = 4; }},
      {"period nan",
       [](RegionHeader& h) {
         h.dimension_kind[1] = 1;
         h.period[1] = std::nan("");
       }},
      {"dimension 0 has period 2", [](RegionHeader& h) { h.period[0] = 2; }},
      {"at dimension 0 does not have four dimensions",
       [](RegionHeader& h) { h.dimension_kind[0] = h.dimension_kind[1] = 2; }},
      {"size",
       [](RegionHeader& h) {
         h.capacity = 16;
         h.region_bytes = 4096;
       }},
  };
  for (const auto& [text, spoil] : cases) {
    RegionHeader bad = good;
    spoil(bad);
    try {
      checked_ring_layout(bad, good.region_bytes);
      ADD_FAILURE() << text << " was accepted";
    } catch (const BadRegion& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(checked_ring_layout(good, good.region_bytes - kPage), BadRegion);
  EXPECT_THROW(checked_ring_layout(good, good.region_bytes + kPage), BadRegion);
  EXPECT_THROW(checked_board_layout(good, good.region_bytes), BadRegion);
}

/// What is said of a region that another build has made.
std::string refusal_of(const RegionHeader& header) {
  try {
    checked_ring_layout(header, header.region_bytes);
  } catch (const BadRegion& error) {
    return error.what();
  }
  return "";
}

TEST(Layout, ARegionOfAnotherVersionIsRefusedWithBothVersionsAndHowToGoOn) {
  const std::string own = std::to_string(kLayoutVersion);
  for (const std::uint32_t version : {3U, 9U}) {
    RegionHeader header = ring_header();
    header.mark.version = version;
    header.layout_hash = 5;
    header.kind = 0;  // nothing else of it is looked at
    EXPECT_EQ(refusal_of(header),
              "region has layout version " + std::to_string(version) +
                  ", this splinecast has version " + own +
                  "; use one splinecast for all processes of the stream, or stop those of the "
                  "other version and remove its regions with `splinecast rm`");
  }
  RegionHeader header = ring_header();
  header.layout_hash = 5;
  EXPECT_EQ(refusal_of(header), "region has layout version " + own +
                                    " with hash 5, this splinecast has version " + own +
                                    " with hash " + std::to_string(layout_hash()) +
                                    "; use one build for all processes of the stream, or stop "
                                    "those of the other one and remove its regions with "
                                    "`splinecast rm`");
}

TEST(Layout, AHeaderComesBackAsItWasWritten) {
  testing::RegionBytes bytes(kBodyOffset);
  const ProducerOptions options{.dimensions = 2,
                                .names = {"left", "a name far too long for its thirty-one bytes"},
                                .units = {"rad", "m"},
                                .clock = StreamClock::recorded,
                                .start = {ConditionKind::velocity, {1, -2}}};
  write_header(bytes.span(), make_header(options, 5));
  const RegionHeader header = copy_header(bytes.span());
  EXPECT_EQ(header.stream_id, 5U);
  EXPECT_EQ(start_condition(header), options.start);
  EXPECT_EQ(stream_clock(header), StreamClock::recorded);
  EXPECT_EQ(dimension_names(header)[0], "left");
  EXPECT_EQ(dimension_names(header)[1], std::string(options.names[1]).substr(0, 31));
  EXPECT_EQ(dimension_units(header), options.units);
  EXPECT_THROW((void)copy_header(bytes.span().first(100)), BadRegion);
}

}  // namespace
}  // namespace splinecast::ipc
