#include "apps/messages/json_fields.hpp"

#include <fmt/format.h>

#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"

#ifdef SPLINECAST_HAS_SIMDJSON

#include <simdjson.h>

#include <algorithm>
#include <string>

namespace splinecast::apps {
namespace {

namespace json = simdjson::ondemand;

/// A value that is a field, or that contains fields.
struct Node {
  std::string key;                   ///< in an object
  std::optional<std::size_t> index;  ///< in an array
  std::optional<std::size_t> field{};
  std::vector<Node> children{};
  std::size_t next = 0;  ///< the child that is expected next
};

Node& child_of(Node& node, const std::string& step) {
  const auto found = std::ranges::find(node.children, step, &Node::key);
  if (found != node.children.end()) return *found;
  node.children.push_back({.key = step, .index = parse_count(step)});
  return node.children.back();
}

/// The child for which `fits` holds. Messages of a channel have their fields in the same order, so
/// that the search begins with the child after the last one found.
template <typename Fits>
Node* find_child(Node& node, const Fits& fits) {
  const std::size_t count = node.children.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = node.next + i < count ? node.next + i : node.next + i - count;
    if (!fits(node.children[at])) continue;
    node.next = at + 1 < count ? at + 1 : 0;
    return &node.children[at];
  }
  return nullptr;
}

[[noreturn]] void refuse(simdjson::error_code error) {
  throw MessageError(fmt::format("not JSON: {}", simdjson::error_message(error)));
}

template <typename T>
T value_of(simdjson::simdjson_result<T> result) {
  if (result.error() != simdjson::SUCCESS) refuse(result.error());
  return std::move(result).value_unsafe();
}

}  // namespace

struct JsonFields::Parser {
  explicit Parser(const std::vector<JsonPath>& paths) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Node* node = &root;
      for (const std::string& step : paths[i]) node = &child_of(*node, step);
      node->field = i;
    }
  }

  template <typename Value>
  void take(Value& value, Node& node) {
    const json::json_type type = value_of(value.type());
    if (type == json::json_type::object) {
      for (auto member : value_of(value.get_object())) {
        auto field = value_of(std::move(member));
        const std::string_view key = value_of(field.unescaped_key());
        Node* child = find_child(node, [&](const Node& each) { return each.key == key; });
        if (child != nullptr) take(field.value(), *child);
      }
    } else if (type == json::json_type::array) {
      std::size_t i = 0;
      for (auto element : value_of(value.get_array())) {
        auto item = value_of(std::move(element));
        Node* child = find_child(node, [&](const Node& each) { return each.index == i; });
        if (child != nullptr) take(item, *child);
        ++i;
      }
    } else if (node.field) {
      (*texts)[*node.field] = without_blanks(value_of(raw(value)));
    }
  }

  static simdjson::simdjson_result<std::string_view> raw(json::document& value) {
    return value.raw_json_token();
  }
  static simdjson::simdjson_result<std::string_view> raw(json::value& value) {
    return value.raw_json_token();
  }

  Node root{};
  json::parser parser{};
  std::vector<char> padded{};  ///< the message and the bytes that simdjson may read after it
  std::vector<std::string_view>* texts = nullptr;
};

bool can_read_json() noexcept { return true; }

JsonFields::JsonFields(const std::vector<JsonPath>& paths)
    : parser_(std::make_unique<Parser>(paths)), texts_(paths.size()), paths_(paths) {}

void JsonFields::read(std::string_view message) {
  if (message.size() > kLongestJson) throw MessageError("longer than 1 MiB");
  Parser& parser = *parser_;
  parser.padded.assign(message.begin(), message.end());
  parser.padded.resize(message.size() + simdjson::SIMDJSON_PADDING);
  std::ranges::fill(texts_, std::string_view{});
  parser.texts = &texts_;
  json::document document =
      value_of(parser.parser.iterate(parser.padded.data(), message.size(), parser.padded.size()));
  parser.take(document, parser.root);
}

}  // namespace splinecast::apps

#else

namespace splinecast::apps {

bool can_read_json() noexcept { return false; }

struct JsonFields::Parser {};

JsonFields::JsonFields(const std::vector<JsonPath>& /*paths*/) {
  throw InputError(
      "this build cannot read messages in JSON (built without simdjson; Debian: "
      "libsimdjson-dev)");
}

void JsonFields::read(std::string_view /*message*/) {}

}  // namespace splinecast::apps

#endif

namespace splinecast::apps {

JsonFields::JsonFields(JsonFields&&) noexcept = default;
JsonFields& JsonFields::operator=(JsonFields&&) noexcept = default;
JsonFields::~JsonFields() = default;

std::string_view JsonFields::text(std::size_t i) const { return texts_[i]; }

double JsonFields::number(std::size_t i) const {
  const std::string_view text = texts_[i];
  const auto value = parse_number(text);
  if (!value) {
    throw MessageError(
        text.empty() ? fmt::format("there is no number '{}'", to_string(paths_[i]))
                     : fmt::format("field '{}': {} is not a number", to_string(paths_[i]), text));
  }
  return *value;
}

}  // namespace splinecast::apps
