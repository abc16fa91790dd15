#include "ipc/layout/header.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <tuple>
#include <type_traits>
#include <vector>

#include "ipc/layout/summary.hpp"

/// Each member of a struct is stored at the words that its row in the table names.
namespace splinecast::ipc {
namespace {

/// Fills one member with a unique pattern. Expects the pattern at the words of its row, all other
/// words unchanged, and the same member after decoding.
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

TEST(LayoutTable, EveryHeaderMemberIsStoredAtTheWordsThatItsRowNames) {
  expect_members_at_their_places<RegionHeader>(kHeaderRows, kHeaderFields);
}

TEST(LayoutTable, EverySummaryMemberIsStoredAtTheWordsThatItsRowNames) {
  expect_members_at_their_places<Summary>(kSummaryRows, kSummaryFields);
}

/// A member without a row would not be stored in shared memory.
TEST(LayoutTable, TheRowsOfHeaderAndSummaryNameAllTheirMembers) {
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
  // Three members are stored outside the summary; two flags share one word.
  constexpr std::size_t kElsewhere =
      sizeof(Summary::revision) + sizeof(Summary::settled_until) + sizeof(Summary::changed_from);
  EXPECT_EQ(std::apply(count, kSummaryRows) + kElsewhere, sizeof(Summary) + sizeof(Word));
}

}  // namespace
}  // namespace splinecast::ipc
