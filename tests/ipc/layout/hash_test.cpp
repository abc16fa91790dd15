#include "ipc/layout/table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// Any two layouts have different hashes.
namespace splinecast::ipc {
namespace {

/// A modifiable copy of the parts of the layout and their tables.
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

TEST(LayoutHash, IsComputedFromTheTables) { EXPECT_EQ(Tables().hash(), layout_hash()); }

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

TEST(LayoutHash, ChangesWhenRowsAreAddedRemovedOrSwapped) {
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

TEST(LayoutHash, ChangesWhenPartsAreSwappedOrRenamed) {
  Tables tables;
  std::swap(tables.parts[0], tables.parts[1]);
  std::swap(tables.fields[0], tables.fields[1]);
  EXPECT_NE(tables.hash(), layout_hash());
  Tables renamed;
  renamed.parts[3].name = "another";
  EXPECT_NE(renamed.hash(), layout_hash());
}

TEST(LayoutHash, DoesNotDependOnMeanings) {
  Tables tables;
  tables.fields[1][3].meaning = "otherwise";
  EXPECT_EQ(tables.hash(), layout_hash());
}

}  // namespace
}  // namespace splinecast::ipc
