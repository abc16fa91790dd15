#include "apps/record/output/accounts.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/record/output/overflow.hpp"
#include "apps/record/verification/coverage.hpp"

/// The accounts of a recorder: every item is counted once.
namespace splinecast::apps::record {
namespace {

Bytes bytes_of(RecordKind kind, const std::string& text) {
  Bytes bytes{static_cast<std::byte>(kind)};
  ByteWriter(bytes).put(std::string_view(text));
  return bytes;
}

Record options(std::uint32_t stream, ipc::Word id, bool has_solver = true) {
  return {.stream = stream,
          .kind = RecordKind::options,
          .number = id,
          .next = has_solver ? 1U : 0U,
          .bytes = bytes_of(RecordKind::options, R"({"stream":"arm"})")};
}

Record numbered(RecordKind kind, ipc::Word number, std::uint32_t stream = 1) {
  return {.stream = stream, .kind = kind, .number = number, .next = number + 1};
}

Record loss(const Loss& loss) {
  return {.stream = 1, .kind = RecordKind::loss, .bytes = encode(loss)};
}

void add(Accounts& accounts, Record record) { accounts.add(record); }

TEST(RecordAccounts, AnItemThatIsReadAgainIsCountedOnce) {
  Accounts accounts;
  add(accounts, options(1, 7));
  for (const ipc::Word n : {0U, 1U, 2U, 0U, 1U, 2U, 3U}) {
    add(accounts, numbered(RecordKind::item, n));
  }
  EXPECT_EQ(accounts.total().items.recorded, 4U);
  EXPECT_EQ(accounts.total().items.end, 4U);
}

TEST(RecordAccounts, ItemsAreRecordedOrLostOrUnwantedAlsoOfStreamsThatHaveEnded) {
  Accounts accounts;
  add(accounts, options(1, 7));
  add(accounts, loss({.cause = LossCause::before, .items = {.first = 0, .count = 5}}));
  std::vector<Record> read;
  for (ipc::Word n = 5; n < 10; ++n) {
    Record record = numbered(RecordKind::item, n);
    accounts.add(record);
    read.push_back(record);
  }
  add(accounts, options(1, 8));  // another stream of the same name
  add(accounts, numbered(RecordKind::item, 0));
  accounts.forget(read[0], 7, true);
  accounts.forget(read[1], 7, false);
  const Account total = accounts.total();
  EXPECT_EQ(total.items.end, 11U);
  EXPECT_EQ(total.items.recorded, 4U);
  EXPECT_EQ(total.items.unwritten, 1U);
  EXPECT_EQ(total.all_lost().items, 6U);
  EXPECT_EQ(lost_in_words(total.lost), "6 items lost (disk 1, before attaching 5)");
  ASSERT_EQ(accounts.losses().size(), 1U);
  EXPECT_EQ(accounts.losses()[0], "'arm': 6 items lost (disk 1, before attaching 5)");
  EXPECT_EQ(accounts.changed({1, 7}, true)->items.end, 10U);
  EXPECT_EQ(accounts.changed({1, 8}, true)->items.end, 1U);
  accounts.tidy(Time(1), [](const auto& /*stream*/) { return true; });
  EXPECT_NE(accounts.changed({1, 7}, true), nullptr);
  accounts.tidy(Time(1), [](const auto& /*stream*/) { return false; });
  EXPECT_EQ(accounts.changed({1, 7}, true), nullptr);
  EXPECT_EQ(accounts.total().items.end, 11U);
}

TEST(RecordAccounts, TheSegmentsOfASecondBoardFollowThoseOfTheFirst) {
  Accounts accounts;
  add(accounts, options(1, 7, false));
  add(accounts, options(1, 7));
  for (ipc::Word n = 1; n <= 3; ++n) add(accounts, numbered(RecordKind::segment, n));
  add(accounts, options(1, 7));
  for (ipc::Word n = 1; n <= 2; ++n) add(accounts, numbered(RecordKind::segment, n));
  EXPECT_EQ(accounts.total().segments.recorded, 5U);
  EXPECT_EQ(accounts.total().segments.end, 5U);
}

/// Batches that are dropped at random: by the records that remain, every item is there or lost, and
/// no options are missing.
TEST(RecordOverflow, WhatIsDroppedIsLostWithItsNumbersAndOptionsStay) {
  std::mt19937 random(5);
  for (int run = 0; run < 200; ++run) {
    Overflow overflow;
    std::vector<Record> delivered;
    ipc::Word next = 0;
    ipc::Word id = 1;
    ipc::Word sent = 0;
    for (int b = 0; b < 30; ++b) {
      Batch batch;
      if (b == 0 || random() % 5 == 0) {
        batch.add(options(1, id++));
        next = 0;
      }
      for (std::size_t n = random() % 4; n > 0; --n, ++sent) {
        batch.add(numbered(RecordKind::item, next++));
      }
      if (random() % 2 == 0 && b < 29) {
        overflow.take(batch);
        EXPECT_TRUE(batch.records.empty());
        continue;
      }
      if (!overflow.is_empty()) overflow.prepend_to(batch);
      for (Record& record : batch.records) delivered.push_back(std::move(record));
    }
    Accounts accounts;
    std::set<ipc::Word> ids;
    for (Record& record : delivered) {
      if (record.kind == RecordKind::options) ids.insert(record.number);
      accounts.add(record);
    }
    const Account total = accounts.total();
    EXPECT_EQ(ids.size(), id - 1);
    EXPECT_EQ(total.items.recorded + total.all_lost().items, sent);
    EXPECT_EQ(total.lost[static_cast<std::size_t>(LossCause::overwritten)].items, 0U);
  }
}

TEST(RecordLosses, ManyLossesBecomeFewWithoutANumberTooManyOrTooFew) {
  LossList list;
  for (ipc::Word n = 0; n < 1000; ++n) {
    const auto cause = n % 2 == 0 ? LossCause::queue : LossCause::overwritten;
    list.add({.cause = cause, .items = {.first = n, .count = 1}});
  }
  EXPECT_LE(list.losses().size(), LossList::kMost);
  Coverage covered;
  ipc::Word sum = 0;
  for (const Loss& loss : list.losses()) {
    covered.add(loss.items);
    sum += loss.items.count;
  }
  EXPECT_EQ(covered.missing(0, 1000), 0U);
  EXPECT_EQ(sum, 1000U);
}

TEST(RecordLosses, WhatIsNeitherThereNorLostIsMissing) {
  Coverage covered;
  for (const NumberSpan range : {NumberSpan{5, 5}, {10, 2}, {0, 3}, {20, 1}}) covered.add(range);
  EXPECT_EQ(covered.missing(0, 12), 2U);
  EXPECT_EQ(covered.missing(0, 25), 14U);
  EXPECT_EQ(covered.missing(6, 12), 0U);
}

}  // namespace
}  // namespace splinecast::apps::record
