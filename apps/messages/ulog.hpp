#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/messages/ulog_format.hpp"

namespace splinecast::apps::ulog {

/// A topic of the log: one instance of a logged format.
struct Topic {
  std::string name{};
  unsigned instance = 0;
  std::vector<Field> fields{};
};

/// One logged sample of a topic.
struct Sample {
  std::size_t topic = 0;              ///< index in topics()
  std::uint64_t microseconds = 0;     ///< its field `timestamp`: time since the boot
  std::span<const std::byte> data{};  ///< the fields, at their offsets
  std::uint64_t number = 0;           ///< of the sample among those of its topic, from 1
};

/// The pauses of the logger, in which samples were lost.
struct Dropouts {
  std::uint64_t count = 0;
  std::uint64_t milliseconds = 0;
};

/// Whether a file begins as a ULog does.
[[nodiscard]] bool is_ulog(std::span<const std::byte> file) noexcept;

/// Reads a ULog of PX4 in the order of the file. A file that is cut off ends with its last whole
/// message. Messages of types that it does not know are left out, as the specification says. Throws
/// MessageError with the byte offset for definitions that are not valid, a sample of an unknown
/// topic, and a sample that is shorter than its format. `file` must outlive the reader.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> file);

  /// The topics of which samples were met so far.
  [[nodiscard]] const std::vector<Topic>& topics() const noexcept { return topics_; }
  /// The next sample; false at the end of the file.
  bool next(Sample& sample);
  /// To the first sample, as after the construction.
  void rewind();

  [[nodiscard]] const Dropouts& dropouts() const noexcept { return dropouts_; }
  [[nodiscard]] bool ended_early() const noexcept { return ended_early_; }
  /// Texts of the file's `I` messages: `ver_hw` and others.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& information() const {
    return information_;
  }

 private:
  struct Record {
    char type = 0;
    std::span<const std::byte> content{};
    std::size_t offset = 0;  ///< of the content, in the file
  };

  bool next_record(Record& record);
  void take_flags(const Record& record);
  void take_information(const Record& record);
  void take_subscription(const Record& record);
  bool take_sample(const Record& record, Sample& sample);
  void take(const Record& record);
  [[noreturn]] static void fail(std::size_t offset, const std::string& what);

  std::span<const std::byte> file_;
  std::size_t at_ = 0;
  std::vector<std::uint64_t> appended_{};  ///< offsets of appended data that are not read yet
  Formats formats_{};
  std::vector<Topic> topics_{};
  std::vector<std::uint64_t> counts_{};            ///< samples of each topic so far
  std::vector<std::size_t> sizes_{};               ///< least bytes of a sample of each topic
  std::vector<std::optional<std::size_t>> ids_{};  ///< index of the topic of each message id
  Dropouts dropouts_{};
  std::vector<std::pair<std::string, std::string>> information_{};
  bool ended_early_ = false;
};

}  // namespace splinecast::apps::ulog
