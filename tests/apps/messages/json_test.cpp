#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/messages/json_fields.hpp"
#include "apps/messages/json_path.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "tests/fixtures/processes/allocations.hpp"

/// Paths of fields in JSON messages, and their values.
namespace splinecast::apps {
namespace {

TEST(JsonPath, HasKeysAndIndexes) {
  EXPECT_EQ(parse_json_path("pose.position.x"), (JsonPath{"pose", "position", "x"}));
  EXPECT_EQ(parse_json_path("joints[0]"), (JsonPath{"joints", "0"}));
  EXPECT_EQ(parse_json_path("joints.0"), (JsonPath{"joints", "0"}));
  EXPECT_EQ(parse_json_path("a[1][2].b"), (JsonPath{"a", "1", "2", "b"}));
  EXPECT_EQ(parse_json_path(R"(a["x.y[0]"].b)"), (JsonPath{"a", "x.y[0]", "b"}));
  EXPECT_EQ(parse_json_path("[3]"), (JsonPath{"3"}));
}

TEST(JsonPath, IsRefusedIfItIsNotOne) {
  for (const char* text :
       {"", ".", "a.", ".a", "a..b", "a[", "a[]", "a[x]", "a[0]b", "a[\"b", "[-1]"}) {
    EXPECT_THROW((void)parse_json_path(text), InputError) << text;
  }
  std::string deep = "a";
  for (int i = 0; i < 32; ++i) deep += ".a";
  EXPECT_THROW((void)parse_json_path(deep), InputError);
}

TEST(JsonPath, PrintsToATextThatParsesToIt) {
  for (const char* text :
       {"pose.position.x", "joints[0]", "a[1][2].b", R"(a["x.y[0]"].b)", R"([""].a)"}) {
    EXPECT_EQ(to_string(parse_json_path(text)), text);
  }
}

TEST(JsonPath, PathsOfNumbersAreInTheOrderOfTheMessage) {
  const auto paths = paths_of_numbers(
      R"({"z": 1, "name": "n", "pose": {"y": -2.5, "x": [1, null, 3e5]}, "on": true})");
  std::vector<std::string> texts;
  for (const JsonPath& path : paths) texts.push_back(to_string(path));
  EXPECT_EQ(texts, (std::vector<std::string>{"z", "pose.y", "pose.x[0]", "pose.x[2]"}));
  EXPECT_TRUE(paths_of_numbers("3").empty()) << "a message that is a number has no path";
  EXPECT_THROW((void)paths_of_numbers("{"), MessageError);
  EXPECT_THROW((void)paths_of_numbers(std::string((std::size_t{1} << 20U) + 1, ' ')), MessageError);
}

class JsonFieldsOf : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!can_read_json()) GTEST_SKIP() << "built without simdjson";
  }
  static JsonFields fields(const std::vector<std::string>& texts) {
    std::vector<JsonPath> paths;
    for (const std::string& text : texts) paths.push_back(parse_json_path(text));
    return JsonFields(paths);
  }
  static std::string error_of(JsonFields& fields, std::string_view message) {
    try {
      fields.read(message);
      (void)fields.number(0);
    } catch (const MessageError& error) {
      return error.what();
    }
    return "none";
  }
};

TEST_F(JsonFieldsOf, AMessageAreFoundInAnyOrder) {
  JsonFields found = fields({"pose.position.x", "joints[1]", "stamp.sec", "stamp"});
  for (
      const char* message :
      {R"({"joints": [1, -0.1, 3], "stamp": {"nsec": 5, "sec": 7}, "pose": {"a": {"x": 9}, "position": {"x": 1e-7}}})",
       R"({"pose": {"position": {"y": 0, "x": 1e-7}}, "other": [[{"pose": 1}]], "stamp": {"sec": 7}, "joints": [[], -0.1]})"}) {
    found.read(message);
    EXPECT_EQ(found.number(0), 1e-7);
    EXPECT_EQ(found.number(1), -0.1);
    EXPECT_EQ(found.text(2), "7");
    EXPECT_EQ(found.text(3), "") << "an object has no text";
  }
}

TEST_F(JsonFieldsOf, AMessageKeepEveryDigit) {
  JsonFields found = fields({"t", "x", "s"});
  found.read(
      R"({"t": 1403636579.763555584, "x": 0.1000000000000000055511151231257827, "s": "12"})");
  EXPECT_EQ(parse_time(found.text(0), TimeUnit::seconds), Time(1403636579763555584));
  EXPECT_EQ(found.number(1), 0.1);
  EXPECT_EQ(found.number(2), 12) << "protobuf's JSON writes integers of 64 bits as strings";
}

TEST_F(JsonFieldsOf, AMessageThatAreMissingOrNotNumbersAreNamed) {
  JsonFields found = fields({"a.b"});
  EXPECT_EQ(error_of(found, R"({"a": {"c": 1}})"), "there is no number 'a.b'");
  EXPECT_EQ(error_of(found, R"({"a": {"b": null}})"), "field 'a.b': null is not a number");
  EXPECT_EQ(error_of(found, R"({"a": {"b": "one"}})"), "field 'a.b': \"one\" is not a number");
  EXPECT_EQ(error_of(found, R"({"a": 3})"), "there is no number 'a.b'");
  found.read(R"({"a": {"b": 1}})");
  found.read(R"({})");
  EXPECT_EQ(found.text(0), "") << "of this message, not of the one before";
}

TEST_F(JsonFieldsOf, TextThatIsNotJsonAreRefused) {
  JsonFields found = fields({"a.b"});
  for (const char* message : {"", "{", R"({"a")", R"({"a": {"b": 1)", R"({"a": })", "]", "\xff"}) {
    EXPECT_NE(error_of(found, message), "none") << message;
  }
  EXPECT_EQ(error_of(found, std::string((std::size_t{1} << 20U) + 1, ' ')), "longer than 1 MiB");
}

TEST_F(JsonFieldsOf, AMessageAreReadWithoutAnAllocation) {
  JsonFields found = fields({"t", "x[0]", "x[6]"});
  const std::string message = R"({"t": 12.5, "x": [1.5, 2, 3, 4, 5, 6, 7.25]})";
  found.read(message);
  const auto before = testing::allocations();
  for (int i = 0; i < 100; ++i) found.read(message);
  EXPECT_EQ(testing::allocations() - before, 0U);
  EXPECT_EQ(found.number(2), 7.25);
}

}  // namespace
}  // namespace splinecast::apps
