#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/time.hpp"

/// What a file of waypoints or of a robot's log contains.
namespace splinecast::apps {

/// A time without messages of a topic.
struct Pause {
  Time begin{};
  Time length{};
};

/// The times of a topic's messages, one after the other. Needs the same memory for any number.
class TimeSpans {
 public:
  static constexpr std::size_t kPauses = 3;

  /// `may_repeat`: the same time again is in order.
  void add(Time time, bool may_repeat = false);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::optional<Time> first() const noexcept { return first_; }
  [[nodiscard]] std::optional<Time> last() const noexcept { return last_; }
  /// Messages that are not after the one before them.
  [[nodiscard]] std::uint64_t not_increasing() const noexcept { return not_increasing_; }
  /// The longest pauses, the longest first: at most kPauses.
  [[nodiscard]] const std::vector<Pause>& pauses() const noexcept { return pauses_; }
  /// Messages in a second on average; 0 for fewer than two.
  [[nodiscard]] double rate() const noexcept;

 private:
  std::uint64_t count_ = 0;
  std::uint64_t not_increasing_ = 0;
  std::optional<Time> first_{};
  std::optional<Time> last_{};
  std::vector<Pause> pauses_{};
};

struct TopicContents {
  std::string name;
  std::string type{};
  std::string encoding{};
  TimeSpans times{};
};

/// An event of a recording.
struct RecordedEvent {
  Time log_time{};
  Time publish_time{};
  std::string topic;
  std::string text;  ///< the message, in JSON
};

struct FileContents {
  std::string file;
  std::string format;  ///< `MCAP`, `ULog` or `table`
  std::string written_by{};
  bool is_complete = true;
  std::string damage{};  ///< why the rest of the file cannot be read; or empty
  std::vector<TopicContents> topics{};
  std::vector<std::string> columns{};             ///< of a table
  std::optional<std::uint64_t> bad_rows{};        ///< of a table
  std::optional<std::uint64_t> dropouts{};        ///< of a ULog
  std::map<std::string, std::uint64_t> events{};  ///< of a recording, by name: how often
  std::vector<RecordedEvent> event_list{};        ///< of a recording: at most kEventsListed
  std::uint64_t lost = 0;                         ///< of a recording: records it could not keep
  Time dropped{};                                 ///< duration of these
  std::vector<std::pair<std::string, std::map<std::string, std::string>>> metadata{};
};

/// Number of events that are listed; all are counted.
inline constexpr std::size_t kEventsListed = 10'000;

/// Reads a file to its end. Throws InputError if it cannot be read at all.
[[nodiscard]] FileContents contents_of(const std::string& path);

[[nodiscard]] nlohmann::ordered_json to_json(const FileContents& contents);
/// The same for people.
[[nodiscard]] std::string to_text(const FileContents& contents);

/// The events of a recording, one in a line: wall clock, topic, message.
[[nodiscard]] std::string events_text(const FileContents& contents);

}  // namespace splinecast::apps
