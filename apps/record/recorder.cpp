#include "apps/record/recorder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/output/stream.hpp"
#include "apps/process/descriptors.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/output/overflow.hpp"
#include "apps/record/output/writer_thread.hpp"
#include "apps/record/trigger/send.hpp"
#include "apps/record/trigger/server.hpp"
#include "apps/record/watch/watcher.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps::record {
namespace {

/// Records wait this long, or until there are this many bytes of them, before they go to the
/// writer.
constexpr Time kBatch = std::chrono::milliseconds(50);
constexpr std::size_t kBatchBytes = std::size_t{256} << 10U;
constexpr Time kLookAtTriggers = std::chrono::milliseconds(50);

class Recorder {
 public:
  explicit Recorder(const RecordOptions& options)
      : options_(options),
        watcher_(options.wanted, options.trust,
                 [&options](std::string_view stream, std::string_view why, bool is_lost) {
                   if (is_lost || !options.quiet) say(fmt::format("'{}': {}", stream, why));
                 }),
        triggers_(options.name),
        writer_(options.output, watcher_.clock()) {
    if (!options.quiet) {
      say(fmt::format("process {}: recording to {}{}", getpid(), options.output.path,
                      options.output.last ? ", from memory when an event occurs" : ""));
    }
  }

  OutputReport run() {
    const Time end = options_.duration ? clock_.now() + *options_.duration : Time::max();
    while (!stop_requested() && clock_.now() < end && !has_ended()) {
      watcher_.sweep(batch_, !overflow_.is_full());
      look_at_triggers();
      const Time now = clock_.now();
      if (batch_.bytes >= kBatchBytes || now >= next_put_) put(now);
      const Time pause = watcher_.next_pause();
      if (pause > Time::zero()) (void)sleep_until(std::min(now + pause, end));
    }
    watcher_.finish(batch_);
    put(clock_.now());
    overflow_.prepend_to(batch_);
    OutputReport report = writer_.finish(std::move(batch_));
    answer_triggers();
    return report;
  }

 private:
  [[nodiscard]] bool has_ended() const noexcept {
    return options_.until_finished && watcher_.are_all_finished();
  }

  void put(Time now) {
    next_put_ = now + kBatch;
    if (batch_.records.empty() && overflow_.is_empty()) return;
    if (!writer_.has_room(batch_)) return drop();
    if (!overflow_.is_empty()) overflow_.prepend_to(batch_);
    writer_.put(batch_);
  }

  void drop() {
    if (batch_.records.empty()) return;
    if (!std::exchange(has_dropped_, true)) {
      say("the disk is too slow: records are dropped, and counted in the file");
    }
    watcher_.note_dropped(batch_);
    overflow_.take(batch_);
  }

  void look_at_triggers() {
    const Time now = clock_.now();
    if (now < next_trigger_) return;
    next_trigger_ = now + kLookAtTriggers;
    answer_triggers();
    if (!triggers_.poll()) return;
    put(now);
    writer_.trigger();
  }

  void answer_triggers() {
    const auto done = writer_.take_trigger_result();
    if (done) triggers_.answer(done->is_done, done->text);
  }

  const RecordOptions& options_;
  MonotonicClock clock_;
  Watcher watcher_;
  TriggerServer triggers_;
  WriterThread writer_;
  Batch batch_;
  Time next_put_{};
  Time next_trigger_{};
  Overflow overflow_;
  bool has_dropped_ = false;  ///< which has been said
};

std::uint64_t count_of(const OutputReport& report, RecordKind kind) {
  const auto found = report.records.find(kind);
  return found != report.records.end() ? found->second : 0;
}

std::string in_words(const OutputReport& report) {
  const auto s = [](std::uint64_t count) { return count == 1 ? "" : "s"; };
  std::string text = fmt::format("{} items and {} segments recorded in {} file{}, {} bytes; {}",
                                 report.account.items.recorded, report.account.segments.recorded,
                                 report.files.size(), s(report.files.size()), report.bytes,
                                 lost_in_words(report.account.lost));
  if (report.further_events > 0) {
    text += fmt::format("; {} further event{} in these dumps", report.further_events,
                        s(report.further_events));
  }
  return text;
}

nlohmann::ordered_json to_json(const OutputReport& report) {
  const LossCounts& queue = report.account.lost.at(static_cast<std::size_t>(LossCause::queue));
  return {{"files", report.files},
          {"bytes", report.bytes},
          {"items", report.account.items.recorded},
          {"segments", report.account.segments.recorded},
          {"refusals", count_of(report, RecordKind::refusal)},
          {"events", count_of(report, RecordKind::event)},
          {"dropped", queue.all()},
          {"lost", report.account.all_lost().all()},
          {"lost_items", report.account.all_lost().items},
          {"lost_segments", report.account.all_lost().segments},
          {"reasons", reasons_json(report.account.lost)},
          {"failures", report.failures},
          {"further_events", report.further_events}};
}

}  // namespace

int run_record(const RecordOptions& options) {
  if (!options.trigger.empty()) {
    print_report(send_trigger(options.trigger) + "\n");
    return kOk;
  }
  mcap::require_mcap();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that has reached RLIMIT_FSIZE is an error of write(2)
  catch_trigger_signal();
  catch_stop_signals();
  raise_descriptor_limit();
  Recorder recorder(options);
  const OutputReport report = recorder.run();
  if (options.json) {
    print_report(to_json(report).dump(2) + "\n");
  } else if (!options.quiet) {
    for (const std::string& line : report.losses) say(line);
    say(in_words(report));
  }
  return report.account.all_lost().all() > 0 ? kIncomplete : kOk;
}

}  // namespace splinecast::apps::record
