#include <fmt/format.h>
#include <fmt/ranges.h>

#include <span>

#include "apps/mcap/input/reader.hpp"
#include "apps/messages/bytes.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/topics/choice.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "apps/tables/topics/mcap_topics.hpp"

/// MCAP: the messages of one topic.
namespace splinecast::apps {
namespace {

class McapRows final : public RowReader {
 public:
  McapRows(InputFile file, const TableOptions& options)
      : file_(std::move(file)),
        is_quiet_(options.quiet),
        reader_(file_.name(), bytes_of(file_.mapped())),
        topic_(choose_topic(file_.name(), topics_of(reader_), options.topic)) {
    open_decoder(options);
    reader_.rewind();
    messages_ = 0;
    survey();
    if (is_quiet_) return;
    say(fmt::format("{}: topic {}: time: {}; positions: {}", file_.name(), topic_.name,
                    decoder_->time_name(), fmt::join(decoder_->columns().names, ", ")));
  }

  [[nodiscard]] const std::string& name() const override { return file_.name(); }
  [[nodiscard]] const RowColumns& columns() const override { return decoder_->columns(); }

  bool next(Row& row) override {
    row.number = messages_;
    try {
      while (!decoder_->next(row)) {
        if (is_at_end_) return false;
        TopicMessage message;
        if (next_message(message)) {
          row.number = message.number;
          decoder_->take(message);
        } else {
          end();
        }
      }
    } catch (const MessageError& bad) {
      throw InputError(fmt::format("{}: {}", where(row.number), bad.what()));
    } catch (const InputError& damage) {
      row.number = 0;  // the rest of the file cannot be read
      end();
      throw InputError(
          fmt::format("{} (splinecast recover keeps what can be read)", damage.what()));
    }
    if (!is_time_in_range(row.time)) {
      throw InputError(fmt::format("{}: the time is not within ±(2^62 − 1) ns, about 146 years",
                                   where(row.number)));
    }
    return true;
  }

  void rewind() override {
    file_.require_same();
    (void)file_.read(0, std::span(&first_, 1));
    reader_.rewind();
    decoder_->rewind();
    messages_ = 0;
    is_at_end_ = false;
  }

  [[nodiscard]] std::string where(std::size_t number) const override {
    return fmt::format("{}: message {} of {}", file_.name(), number, shown(topic_.name));
  }

  [[nodiscard]] std::string_view row_name() const noexcept override { return "message"; }

  [[nodiscard]] double fraction_read() const override {
    return topic_.messages == 0
               ? 1
               : static_cast<double>(messages_) / static_cast<double>(topic_.messages);
  }

 private:
  void open_decoder(const TableOptions& options) {
    TopicMessage first;
    if (!next_message(first)) {
      throw InputError(fmt::format("{}: topic {} has no messages", file_.name(), topic_.name));
    }
    try {
      decoder_ = message_type(topic_.encoding, topic_.type)
                     ->open({.first = first,
                             .schema = channel_->schema_data,
                             .name = topic_.name,
                             .metadata = reader_.metadata()},
                            options);
    } catch (const MessageError& bad) {
      throw InputError(fmt::format("{}: {}", where(1), bad.what()));
    } catch (const InputError& bad) {
      throw InputError(fmt::format("{}: topic {}: {}", file_.name(), topic_.name, bad.what()));
    }
  }

  /// Passes all messages to the decoder, up to where the file is damaged.
  void survey() {
    if (!decoder_->wants_survey()) return;
    TopicMessage message;
    try {
      while (next_message(message)) decoder_->survey(message);
    } catch (const InputError&) {  // next() reports it
      channel_ = nullptr;
    }
    reader_.rewind();
    decoder_->rewind();
    messages_ = 0;
  }

  /// The next message of the topic; false at the end.
  bool next_message(TopicMessage& message) {
    mcap::Message read;
    while (reader_.next(read)) {
      if (read.channel != channel_) {
        if (!is_of(*read.channel, topic_)) continue;
        channel_ = read.channel;
      }
      message = {.number = ++messages_,
                 .log_time = read.log_time,
                 .publish_time = read.publish_time,
                 .data = read.data};
      return true;
    }
    return false;
  }

  void end() {
    is_at_end_ = true;
    decoder_->finish();
    if (!reader_.ended_early() || is_quiet_ || is_reported_) return;
    is_reported_ = true;
    say(
        fmt::format("{}: the file is cut off: read up to its last whole chunk (splinecast recover "
                    "makes a complete file of it)",
                    file_.name()));
  }

  InputFile file_;
  bool is_quiet_;
  mcap::Reader reader_;
  TopicSummary topic_;
  std::unique_ptr<MessageDecoder> decoder_{};
  const mcap::Channel* channel_ = nullptr;  ///< of the last message of the topic
  std::uint64_t messages_ = 0;              ///< of the topic, so far
  bool is_at_end_ = false;
  bool is_reported_ = false;
  char first_ = 0;
};

bool is_mcap(const FileBeginning& beginning) {
  return !beginning.bytes.empty() && mcap::is_mcap(bytes_of(beginning.bytes));
}

std::unique_ptr<RowReader> open_mcap(InputFile file, const TableOptions& options) {
  return std::make_unique<McapRows>(std::move(file), options);
}

const InputFormat mcap_format(20, is_mcap, open_mcap);

}  // namespace
}  // namespace splinecast::apps
