#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mcap/input/reader.hpp"
#include "apps/tables/options.hpp"
#include "apps/tables/rows.hpp"
#include "splinecast/time.hpp"

/// Rows from the messages of a topic.
namespace splinecast::apps {

/// A message of the topic.
struct TopicMessage {
  std::uint64_t number = 0;  ///< among the messages of the topic, from 1
  Time log_time{};
  Time publish_time{};
  std::span<const std::byte> data{};
};

/// What a decoder is made from.
struct TopicBeginning {
  TopicMessage first{};                        ///< the first message
  std::string_view schema{};                   ///< of the topic's messages
  std::string_view name{};                     ///< of the topic
  std::span<const mcap::Metadata> metadata{};  ///< of the file
};

/// Makes rows of messages. Decoding allocates nothing once it has seen messages of the same size.
class MessageDecoder {
 public:
  MessageDecoder() = default;
  MessageDecoder(const MessageDecoder&) = delete;
  MessageDecoder& operator=(const MessageDecoder&) = delete;
  virtual ~MessageDecoder() = default;

  [[nodiscard]] virtual const RowColumns& columns() const = 0;
  /// What the time of a row is, for messages: `header.stamp`, `log time`.
  [[nodiscard]] virtual std::string time_name() const = 0;

  /// Takes a message. Throws MessageError if it cannot be decoded; it then gives no row.
  virtual void take(const TopicMessage& message) = 0;
  /// Call it after the last message.
  virtual void finish() {}
  /// The next row of the messages taken so far; false if it needs another message. The views are
  /// valid until the next call of a function that changes the decoder. Throws MessageError for a
  /// row that is not valid, after setting its number; the next call continues after it.
  virtual bool next(Row& row) = 0;
  /// Forgets all messages.
  virtual void rewind() = 0;

  /// Whether all messages are to be passed to survey(), followed by rewind(), before the first one
  /// is taken.
  [[nodiscard]] virtual bool wants_survey() const { return false; }
  virtual void survey(const TopicMessage& /*message*/) {}
};

/// A decoder of messages that give one row each.
class SingleRowDecoder : public MessageDecoder {
 public:
  void take(const TopicMessage& message) final {
    has_row_ = false;
    row_ = decode(message);
    has_row_ = true;
  }
  bool next(Row& row) final {
    if (!has_row_) return false;
    row = row_;
    has_row_ = false;
    return true;
  }
  void rewind() final { has_row_ = false; }

 private:
  [[nodiscard]] virtual Row decode(const TopicMessage& message) = 0;

  Row row_{};
  bool has_row_ = false;
};

/// A type of messages that gives rows.
struct MessageType {
  std::string_view encoding;  ///< of the messages: `cdr`, `json`
  std::string_view name;      ///< of the schema; empty: any
  /// Makes a decoder for a topic. Throws InputError if the options do
  /// not fit, and MessageError if the message cannot be decoded.
  std::unique_ptr<MessageDecoder> (*open)(const TopicBeginning& topic, const TableOptions& options);
};

/// The type of messages with this encoding and schema, or null.
[[nodiscard]] const MessageType* message_type(std::string_view encoding, std::string_view schema);

[[nodiscard]] std::unique_ptr<MessageDecoder> open_joint_state(const TopicBeginning& topic,
                                                               const TableOptions& options);
[[nodiscard]] std::unique_ptr<MessageDecoder> open_joint_trajectory(const TopicBeginning& topic,
                                                                    const TableOptions& options);
[[nodiscard]] std::unique_ptr<MessageDecoder> open_pose_stamped(const TopicBeginning& topic,
                                                                const TableOptions& options);
[[nodiscard]] std::unique_ptr<MessageDecoder> open_odometry(const TopicBeginning& topic,
                                                            const TableOptions& options);
[[nodiscard]] std::unique_ptr<MessageDecoder> open_json(const TopicBeginning& topic,
                                                        const TableOptions& options);

[[nodiscard]] std::unique_ptr<MessageDecoder> open_recorded_stream(const TopicBeginning& topic,
                                                                   const TableOptions& options);

/// The time of a message that the options choose; `stamp` is the one in its header.
[[nodiscard]] Time time_of(const TopicMessage& message, Time stamp, WhichTime which) noexcept;
/// Its name.
[[nodiscard]] std::string name_of_time(WhichTime which, std::string_view header);

/// The names of the values that the options choose with `--joints`, `--field` or `--columns`; none:
/// all. Throws InputError if two of these are given, or more than 64 names, or one twice.
[[nodiscard]] std::vector<std::string> chosen_names(const TableOptions& options);

}  // namespace splinecast::apps
