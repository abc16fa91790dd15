#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/files/numbers.hpp"
#include "apps/messages/json_path.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Whether this program can read JSON messages.
[[nodiscard]] bool can_read_json() noexcept;

/// Finds fields in JSON messages, in one pass over each message, without an allocation per message.
/// It checks the syntax only as far as it is needed to find them. It is built on simdjson: without
/// it the constructor throws InputError, which names the missing package.
class JsonFields {
 public:
  explicit JsonFields(const std::vector<JsonPath>& paths);
  JsonFields(JsonFields&&) noexcept;
  JsonFields& operator=(JsonFields&&) noexcept;
  ~JsonFields();

  /// Finds the fields of a message. Throws MessageError if it is not JSON, or longer than
  /// kLongestJson.
  void read(std::string_view message);

  /// The JSON text of field i, valid until the next read(): a number, a string with its quotes,
  /// `true`, `null`. Empty if there is no such field, or if it is an object or an array.
  [[nodiscard]] std::string_view text(std::size_t i) const;

  /// Field i as a number. Throws MessageError with the path if it is missing or not a number.
  [[nodiscard]] double number(std::size_t i) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::vector<std::string_view> texts_;
  std::vector<JsonPath> paths_;
};

}  // namespace splinecast::apps
