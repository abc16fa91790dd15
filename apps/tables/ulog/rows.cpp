#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "apps/messages/bytes.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/messages/ulog.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/topics/choice.hpp"
#include "apps/tables/ulog/columns.hpp"
#include "apps/tables/ulog/topics.hpp"

/// ULog of PX4: the samples of one topic.
namespace splinecast::apps {
namespace {

class UlogRows final : public RowReader {
 public:
  UlogRows(InputFile file, const TableOptions& options)
      : file_(std::move(file)), is_quiet_(options.quiet), reader_(bytes_of(file_.mapped())) {
    if (options.which_time != WhichTime::header) {
      throw InputError(
          fmt::format("{}: a ULog has no log time: --time-column chooses a field", file_.name()));
    }
    const std::vector<TopicSummary> topics = topics_of(reader_);
    topic_ = choose_topic(file_.name(), topics, without_first_instance(options.topic));
    columns_ = ulog_columns(reader_.topics()[find_topic()].fields, where_topic(), options);
    position_.resize(columns_.fields.size());
    reader_.rewind();
    if (is_quiet_) return;
    say(fmt::format("{}: time: {}; positions: {}", where_topic(), columns_.time.path,
                    fmt::join(columns_.columns.names, ", ")));
  }

  [[nodiscard]] const std::string& name() const override { return file_.name(); }
  [[nodiscard]] const RowColumns& columns() const override { return columns_.columns; }

  bool next(Row& row) override {
    row.number = samples_ + 1;
    ulog::Sample sample;
    try {
      do {
        if (!reader_.next(sample)) return end();
      } while (!is_chosen(sample));
    } catch (const MessageError& bad) {
      throw InputError(fmt::format("{}: {}", file_.name(), bad.what()));
    }
    ++samples_;
    if (sample.data.size() < columns_.bytes) {
      throw InputError(fmt::format("{}: the file has changed", where(row.number)));
    }
    for (std::size_t i = 0; i < position_.size(); ++i) {
      position_[i] = value_of(columns_.fields[i], sample.data);
    }
    row = {.number = row.number, .time = time_of(sample, row.number), .position = position_};
    return true;
  }

  void rewind() override {
    file_.require_same();
    (void)file_.read(0, std::span(&first_, 1));
    reader_.rewind();
    samples_ = 0;
    index_.reset();
  }

  [[nodiscard]] std::string where(std::size_t number) const override {
    return fmt::format("{}: message {} of {}", file_.name(), number, shown(topic_.name));
  }
  [[nodiscard]] std::string_view row_name() const noexcept override { return "message"; }
  [[nodiscard]] double fraction_read() const override {
    return topic_.messages == 0
               ? 1
               : static_cast<double>(samples_) / static_cast<double>(topic_.messages);
  }

 private:
  [[nodiscard]] std::string where_topic() const {
    return fmt::format("{}: topic {}", file_.name(), shown(topic_.name));
  }

  /// The index of the topic after a pass.
  [[nodiscard]] std::size_t find_topic() const {
    const auto& topics = reader_.topics();
    const auto found = std::ranges::find_if(
        topics, [&](const ulog::Topic& each) { return name_of(each) == topic_.name; });
    return static_cast<std::size_t>(found - topics.begin());
  }

  bool is_chosen(const ulog::Sample& sample) {
    if (!index_ && name_of(reader_.topics()[sample.topic]) == topic_.name) index_ = sample.topic;
    return index_ == sample.topic;
  }

  [[nodiscard]] Time time_of(const ulog::Sample& sample, std::size_t number) const {
    const auto time = columns_.time_of(sample.data);
    if (!time) {
      throw InputError(fmt::format("{}: field '{}' is not within ±(2^62 − 1) ns, about 146 years",
                                   where(number), columns_.time.path));
    }
    return *time;
  }

  bool end() {
    const bool reports = reader_.ended_early() && !is_quiet_ && !is_reported_;
    if (reports) say(fmt::format("{}: the file is cut off", file_.name()));
    is_reported_ = is_reported_ || reports;
    return false;
  }

  InputFile file_;
  bool is_quiet_;
  ulog::Reader reader_;
  TopicSummary topic_{};
  UlogColumns columns_{};
  std::optional<std::size_t> index_{};  ///< of the topic in the reader
  std::vector<double> position_{};
  std::size_t samples_ = 0;
  bool is_reported_ = false;
  char first_ = 0;
};

bool is_ulog(const FileBeginning& beginning) { return ulog::is_ulog(bytes_of(beginning.bytes)); }

std::unique_ptr<RowReader> open_ulog(InputFile file, const TableOptions& options) {
  const std::string name = file.name();
  try {
    return std::make_unique<UlogRows>(std::move(file), options);
  } catch (const MessageError& bad) {
    throw InputError(fmt::format("{}: {}", name, bad.what()));
  }
}

const InputFormat ulog_format(30, is_ulog, open_ulog);

}  // namespace
}  // namespace splinecast::apps
