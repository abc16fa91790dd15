#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "apps/messages/bytes.hpp"
#include "apps/messages/json_fields.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/time_column.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "apps/tables/topics/json_columns.hpp"
#include "splinecast/waypoint.hpp"

/// JSON messages: a row per message, of the numbers at the chosen paths.
namespace splinecast::apps {
namespace {

class JsonRows final : public SingleRowDecoder {
 public:
  explicit JsonRows(JsonColumns columns)
      : columns_(std::move(columns)),
        fields_(columns_.paths),
        position_(columns_.columns.dimensions()) {}

  [[nodiscard]] const RowColumns& columns() const override { return columns_.columns; }
  [[nodiscard]] std::string time_name() const override { return columns_.time.name; }

 private:
  [[nodiscard]] Row decode(const TopicMessage& message) override {
    fields_.read(text_of(message.data));
    for (std::size_t i = 0; i < position_.size(); ++i) position_[i] = fields_.number(i);
    return {.number = static_cast<std::size_t>(message.number),
            .time = columns_.time.of(message, fields_),
            .position = position_};
  }

  JsonColumns columns_;
  JsonFields fields_;
  std::vector<double> position_;
};

}  // namespace

std::unique_ptr<MessageDecoder> open_json(const TopicBeginning& topic,
                                          const TableOptions& options) {
  return std::make_unique<JsonRows>(json_columns(text_of(topic.first.data), options));
}

}  // namespace splinecast::apps
