#include "apps/messages/ulog.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/messages/message_error.hpp"
#include "tests/fixtures/messages/ulog_writer.hpp"

/// Logs of PX4.
namespace splinecast::apps::ulog {
namespace {

using testing::UlogWriter;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string error_of(const std::string& file) {
  try {
    Reader reader(bytes_of(file));
    Sample sample;
    while (reader.next(sample)) continue;
  } catch (const MessageError& error) {
    return error.what();
  }
  return "none";
}

std::vector<std::string> paths_of(const Topic& topic) {
  std::vector<std::string> paths;
  for (const Field& field : topic.fields) paths.push_back(field.path);
  return paths;
}

TEST(Ulog, HasNestedFormatsArraysAndInstances) {
  UlogWriter log;
  log.format("point:float x;double[2] y;uint8_t[4] _padding0;")
      .format("path:uint64_t timestamp;point[2] p;int16_t n;uint8_t[6] _padding0;")
      .subscription(3, "path", 0)
      .subscription(9, "path", 1)
      .sample(3, 1000, 1.5F, 2.5, 3.5, std::uint32_t{0}, -1.5F, -2.5, -3.5, std::uint32_t{0},
              std::int16_t{-7})
      .dropout(20)
      .message('?', "a type of a later version")
      .sample(9, 2000, 1.0F, 2.0, 3.0, std::uint32_t{0}, 4.0F, 5.0, 6.0, std::uint32_t{0},
              std::int16_t{8}, std::uint32_t{0}, std::uint16_t{0})
      .dropout(5);
  const std::string file = log.bytes();
  Reader reader(bytes_of(file));
  Sample sample;
  for (int pass = 0; pass < 2; ++pass) {
    ASSERT_TRUE(reader.next(sample));
    const Topic& topic = reader.topics()[sample.topic];
    EXPECT_EQ(topic.name, "path");
    EXPECT_EQ(paths_of(topic),
              (std::vector<std::string>{"timestamp", "p[0].x", "p[0].y[0]", "p[0].y[1]", "p[1].x",
                                        "p[1].y[0]", "p[1].y[1]", "n"}));
    EXPECT_EQ(sample.microseconds, 1000U);
    std::vector<double> values;
    for (const Field& field : topic.fields) values.push_back(value_of(field, sample.data));
    EXPECT_EQ(values, (std::vector<double>{1000, 1.5, 2.5, 3.5, -1.5, -2.5, -3.5, -7}));
    ASSERT_TRUE(reader.next(sample));
    EXPECT_EQ(reader.topics()[sample.topic].instance, 1U);
    EXPECT_EQ(sample.number, 1U) << "of its own instance";
    EXPECT_FALSE(reader.next(sample));
    EXPECT_EQ(reader.dropouts().count, 2U);
    EXPECT_EQ(reader.dropouts().milliseconds, 25U);
    EXPECT_FALSE(reader.ended_early());
    reader.rewind();
  }
}

TEST(Ulog, ThatIsCutOffEndsWithItsLastWholeMessage) {
  UlogWriter log;
  log.format("a:uint64_t timestamp;float x;").subscription(0, "a");
  const std::size_t before = log.bytes().size();
  log.sample(0, 1, 1.0F).sample(0, 2, 2.0F);
  const std::size_t sample_bytes = (log.bytes().size() - before) / 2;
  for (std::size_t size = 16; size <= log.bytes().size(); ++size) {
    const std::string file = log.bytes().substr(0, size);
    Reader reader(bytes_of(file));
    Sample sample;
    std::size_t samples = 0;
    while (reader.next(sample)) ++samples;
    const bool has_samples = size >= before;
    EXPECT_EQ(samples, has_samples ? (size - before) / sample_bytes : 0) << size;
    if (has_samples) {
      EXPECT_EQ(reader.ended_early(), (size - before) % sample_bytes != 0) << size;
    }
  }
}

TEST(Ulog, HasAppendedDataAfterAMessageThatIsCutOff) {
  const auto with_offset = [](std::uint64_t offset) {
    std::string flags(40, '\0');
    flags[8] = 1;
    std::copy_n(UlogWriter::packed(offset).begin(), 8, flags.begin() + 16);
    UlogWriter log;
    log.message('B', flags).format("a:uint64_t timestamp;float x;").subscription(0, "a");
    log.sample(0, 1, 1.0F).raw(std::string_view("\x20\x00\x44\x00", 4));
    return log;
  };
  const std::uint64_t offset = with_offset(0).bytes().size();
  UlogWriter log = with_offset(offset);
  log.sample(0, 2, 2.0F);
  const std::string file = log.bytes();
  Reader reader(bytes_of(file));
  Sample sample;
  ASSERT_TRUE(reader.next(sample));
  ASSERT_TRUE(reader.next(sample));
  EXPECT_EQ(sample.microseconds, 2U);
  EXPECT_FALSE(reader.next(sample));
  EXPECT_FALSE(reader.ended_early());
}

TEST(Ulog, WithDefinitionsThatAreNotValidIsRefused) {
  EXPECT_NE(error_of("ULog").find("not a ULog"), std::string::npos);
  const auto log = [](std::string_view format) {
    return UlogWriter().format(format).subscription(0, "a").bytes();
  };
  const auto has = [](const std::string& error, std::string_view part) {
    return error.starts_with("byte ") && error.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(error_of(log("a")), "'a' is not a format"));
  EXPECT_TRUE(has(error_of(log("a:float")), "'float' is not a field"));
  EXPECT_TRUE(has(error_of(log("a:float[0] x;")), "is not a field"));
  EXPECT_TRUE(has(error_of(log("a:float[99999999999] x;")), "is not a field"));
  EXPECT_TRUE(has(error_of(log("b:float x;")), "unknown format 'a'"));
  EXPECT_TRUE(has(error_of(log("a:float x;")), "the first field is not uint64_t timestamp"));
  EXPECT_TRUE(has(error_of(log("a:uint64_t timestamp;a b;")), "nested more than 16 levels"));
  EXPECT_TRUE(has(error_of(log("a:uint64_t timestamp;double[9000] x;")), "longer than 65535"));
  EXPECT_TRUE(has(error_of(UlogWriter().message('A', "ab").bytes()), "without a name"));
  EXPECT_TRUE(has(error_of(UlogWriter().message('B', "ab").bytes()), "less than 40 bytes"));
}

TEST(Ulog, WithFormatsOfManyFieldsIsRefusedSoon) {
  UlogWriter nested;
  nested.format("a0:").format("a1:a0[65535] x;").format("a2:a1[65535] x;");
  nested.format("a:uint64_t timestamp;a2[65535] x;").subscription(0, "a");
  EXPECT_NE(error_of(nested.bytes()).find("more than 2^20 fields"), std::string::npos);
}

TEST(Ulog, WithASampleThatDoesNotFitItsFormatIsRefused) {
  UlogWriter log;
  log.format("a:uint64_t timestamp;float x;").subscription(1, "a");
  EXPECT_NE(error_of(UlogWriter(log).sample(0, 1).bytes()).find("message id 0"), std::string::npos);
  EXPECT_NE(error_of(UlogWriter(log).sample(1, 1).bytes()).find("has 8 bytes instead of 12"),
            std::string::npos);
}

}  // namespace
}  // namespace splinecast::apps::ulog
