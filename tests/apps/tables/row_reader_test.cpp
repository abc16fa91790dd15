#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "apps/process/messages.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/kept_rows.hpp"
#include "apps/tables/table_rows.hpp"
#include "apps/tables/waypoints.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Rows read one after the other.
namespace splinecast::apps {
namespace {

using testing::TestFolder;

std::string refusal_of(const std::string& path, const TableOptions& options = {}) {
  try {
    (void)read_waypoints(path, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without an error";
}

/// The rest of a reader as text: each row's number, time and values, or its error.
std::string rest_of(RowReader& rows) {
  std::string text;
  for (Row row;;) {
    try {
      if (!rows.next(row)) return text;
      text += fmt::format("{}: {}", row.number, row.time.count());
      for (const auto values : {row.position, row.velocity, row.acceleration}) {
        text += " |";
        for (const double value : values) text += fmt::format(" {}", value);
      }
    } catch (const InputError& error) {
      if (row.number == 0) throw;
      text += fmt::format("{}: {}", row.number, error.what());
    }
    text += '\n';
  }
}

TEST(TextRows, FieldsAreSeparatedByCommasSemicolonsOrTabs) {
  const TestFolder folder;
  for (const std::string text :
       {"t,x,y\n0,1,2\n0.5,3,4\n", "t;x;y\n0;1;2\n0.5;3;4\n", "t\tx\ty\n0\t1\t2\n0.5\t3\t4\n",
        "# t\tx\ty\n0\t1\t2\n0.5\t3\t4\n", "# t;x;y\n0;1;2\n0.5;3;4\n"}) {
    const WaypointTable table = read_waypoints(folder.write("a.csv", text), {});
    EXPECT_EQ(table.names, (std::vector<std::string>{"x", "y"})) << text;
    EXPECT_EQ(table.positions, (std::vector<double>{1, 2, 3, 4})) << text;
  }
  const auto quoted = folder.write("a.csv", "t;\"a;b\"\n0;1\n1;1,5\n");
  EXPECT_NE(refusal_of(quoted).find("a.csv:3:3: column 'a;b': '1,5' is not a number"),
            std::string::npos)
      << refusal_of(quoted);
}

TEST(TextRows, AMissingTimeColumnIsReportedWithTheSeparatorsThatWereTried) {
  const TestFolder folder;
  EXPECT_NE(refusal_of(folder.write("a.csv", "a;b\n0;1\n")).find("this file has semicolons"),
            std::string::npos);
  EXPECT_NE(refusal_of(folder.write("a.csv", "a\tb\n0\t1\n")).find("this file has tabs"),
            std::string::npos);
  EXPECT_NE(refusal_of(folder.write("a.csv", "t:x\n0:1\n"))
                .find("fields are separated by commas, semicolons or tabs, and this line has none"),
            std::string::npos);
}

TEST(TextRows, TheTimeColumnCanBeNamed) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", "t,x,stamp_ms,clock\n7,1,2000,5\n8,3,2500,6\n");
  EXPECT_NE(refusal_of(path).find("column 3, 'stamp_ms', is a second time column after 't'"),
            std::string::npos);
  const auto stamped = read_waypoints(path, {.time_column = "stamp_ms", .quiet = true});
  EXPECT_EQ(stamped.times, (std::vector<Time>{Time(2'000'000'000), Time(2'500'000'000)}));
  EXPECT_EQ(stamped.names, (std::vector<std::string>{"x", "clock"}));
  const auto other = read_waypoints(
      path, {.time_unit = TimeUnit::milliseconds, .time_column = "clock", .quiet = true});
  EXPECT_EQ(other.times, (std::vector<Time>{Time(5'000'000), Time(6'000'000)}));
  EXPECT_EQ(other.names, std::vector<std::string>{"x"});
  EXPECT_NE(refusal_of(path, {.time_column = "when"}).find("there is no column 'when' among t, x"),
            std::string::npos);
}

TEST(TextRows, TimeColumnsOfRosAndOthersAreKnown) {
  const TestFolder folder;
  const std::vector<std::pair<const char*, std::int64_t>> headers{{"%time,x", 3},
                                                                  {"stamp,x", 3'000'000'000},
                                                                  {"secs,x", 3'000'000'000},
                                                                  {"Stamp [ms],x", 3'000'000},
                                                                  {"__time,x", 3'000'000'000},
                                                                  {"seconds,x", 3'000'000'000}};
  for (const auto& [header, wanted] : headers) {
    const auto path = folder.write("a.csv", std::string(header) + "\n3,1\n");
    EXPECT_EQ(read_waypoints(path, {}).times.at(0).count(), wanted) << header;
  }
}

TEST(TextRows, LongFieldsAreCutAndEscapeCodesAreVisibleInMessages) {
  const TestFolder folder;
  const std::string message =
      refusal_of(folder.write("a.csv", "t,\x1b[31mred\n0,1\n1," + std::string(5000, 'z') + "\n"));
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_NE(message.find("column '\\x1b[31mred': 'zzzzzzzz"), std::string::npos) << message;
  EXPECT_LT(message.size(), 400U);
  EXPECT_EQ(shown("short"), "short");
  EXPECT_EQ(shown(std::string(60, 'a')), std::string(60, 'a'));
  EXPECT_EQ(shown(std::string(59, 'a') + "é" + "rest"), std::string(59, 'a') + "…");
}

TEST(TextRows, ABinaryFileIsNeitherReadNorPrinted) {
  const TestFolder folder;
  const auto path = folder.write("a.bin", std::string("\0\x01\x02PK\n\0\0", 8));
  EXPECT_NE(refusal_of(path).find("a.bin: is neither a text nor of another known format"),
            std::string::npos);
}

TEST(TextRows, RewindBeginsAtTheFirstRow) {
  const TestFolder folder;
  const std::string rows = "0,1\n1,oops\n\n# note\n2,3,4\n3,4\n";
  for (const std::string header : {"t,x\n", "# t,x\n"}) {
    const auto reader = open_rows(folder.write("a.csv", header + rows), {});
    const std::string first = rest_of(*reader);
    EXPECT_EQ(std::ranges::count(first, '\n'), 4) << first;
    reader->rewind();
    EXPECT_EQ(rest_of(*reader), first);
    reader->rewind();
    reader->skip(3);
    EXPECT_EQ(rest_of(*reader), "7: 3000000000 | 4 | |\n");
    EXPECT_EQ(reader->where(7), reader->name() + ":7");
  }
}

/// More rows than KeptRows keeps would take minutes to write; so few, but longer than the buffer of
/// a file.
std::string long_text() {
  std::string text = "t_ns,x,v[0]\n";
  for (int i = 0; i < 50'000; ++i) {
    text += i % 1000 == 7 ? "bad\n" : fmt::format("{},{},{}\n", i, 0.5 * i, -i);
  }
  return text;
}

TEST(TextRows, AFileThatChangesBetweenTwoPassesIsAnErrorAndNoCrash) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", long_text());
  for (const std::uintmax_t size : {std::uintmax_t{0}, std::uintmax_t{300'000}}) {
    (void)folder.write("a.csv", long_text());
    const auto reader = open_rows(path, {});
    (void)rest_of(*reader);
    std::filesystem::resize_file(path, size);
    reader->rewind();
    EXPECT_THROW((void)rest_of(*reader), InputError) << size;
  }
  (void)folder.write("a.csv", long_text());
  const auto reader = open_rows(path, {});
  (void)rest_of(*reader);
  std::ofstream(path, std::ios::app) << "50001,1,1\n";
  reader->rewind();
  EXPECT_THROW((void)rest_of(*reader), InputError);
}

TEST(KeptRows, GiveEachPassTheSameRowsAndErrors) {
  const TestFolder folder;
  const auto path = folder.write("a.csv", long_text());
  const std::string wanted = rest_of(*open_rows(path, {}));
  KeptRows rows(open_rows(path, {}));
  Row row;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(rows.next(row));
  rows.rewind();  // before the end of the first pass
  for (int pass = 0; pass < 3; ++pass) {
    EXPECT_TRUE(testing::same_text(rest_of(rows), wanted)) << pass;
    rows.rewind();
  }
}

TEST(TextRows, PlainAndQuotedNumbersHaveTheSameValues) {
  const TestFolder folder;
  for (const std::string number :
       {"0", "-0", "1.5", "-2.25", "0.1", "123456789012345", "1234567890123456", "3.14159265358979",
        "1e5", "2.5E-3", "9007199254740993", "0.30000000000000004", "1e400", "-1e-400", "5.",
        "000000000000000000001.5", "12345.678901234567"}) {
    const auto plain = read_waypoints(folder.write("a.csv", "t,x\n0," + number + "\n"), {});
    const auto quoted = read_waypoints(folder.write("b.csv", "t,x\n0,\"" + number + "\"\n"), {});
    EXPECT_EQ(plain.positions, quoted.positions) << number;
    EXPECT_EQ(std::signbit(plain.positions[0]), std::signbit(quoted.positions[0])) << number;
    EXPECT_EQ(plain.positions[0], std::strtod(number.c_str(), nullptr)) << number;
  }
}

/// Rows of which only some have a velocity, from a format that only this test knows.
class PartlyMoving final : public RowReader {
 public:
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const RowColumns& columns() const override { return columns_; }
  bool next(Row& row) override {
    if (next_ == 4) return false;
    const std::span<const double> velocity = next_ % 2 == 0 ? value_ : std::span<const double>{};
    row = {.number = next_ + 1, .time = Time(next_), .position = value_, .velocity = velocity};
    ++next_;
    return true;
  }
  void rewind() override { next_ = 0; }
  [[nodiscard]] std::string where(std::size_t number) const override {
    return fmt::format("message {}", number);
  }
  [[nodiscard]] std::string_view row_name() const noexcept override { return "message"; }
  [[nodiscard]] double fraction_read() const override { return next_ / 4.0; }

 private:
  std::string name_ = "partly";
  RowColumns columns_{.names = {"x"}};
  double one_ = 1;
  std::span<const double> value_{&one_, 1};
  unsigned next_ = 0;
};

bool is_partly_moving(const FileBeginning& beginning) {
  return beginning.first == "partly moving, for a test";
}
std::unique_ptr<RowReader> open_partly_moving(InputFile /*file*/, const TableOptions& /*options*/) {
  return std::make_unique<PartlyMoving>();
}
const InputFormat partly_moving(90, is_partly_moving, open_partly_moving);

TEST(RowReader, ATableHasOnlyDerivativesThatEachRowHasAndAPassKeepsThoseOfEachRow) {
  const TestFolder folder;
  const auto path = folder.write("a.txt", "partly moving, for a test\n");
  ::testing::internal::CaptureStderr();
  const WaypointTable table = read_waypoints(path, {});
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "splinecast: partly: 2 of 4 rows have velocities: they are left out\n");
  EXPECT_EQ(table.size(), 4U);
  EXPECT_TRUE(table.velocities.empty());
  EXPECT_EQ(table.where(3), "message 4");
  KeptRows rows(open_rows(path, {}));
  for (int pass = 0; pass < 2; ++pass) {
    EXPECT_EQ(rest_of(rows), "1: 0 | 1 | 1 |\n2: 1 | 1 | |\n3: 2 | 1 | 1 |\n4: 3 | 1 | |\n");
    rows.rewind();
  }
}

}  // namespace
}  // namespace splinecast::apps
