#include "apps/record/recorder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>

#include "apps/output/stream.hpp"
#include "apps/process/descriptors.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/output/writer_thread.hpp"
#include "apps/record/trigger.hpp"
#include "apps/record/watch/watcher.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps::record {
namespace {

/// Records wait this long, or until there are this many bytes of them, before they go to the
/// writer.
constexpr Time kBatch = std::chrono::milliseconds(50);
constexpr std::size_t kBatchBytes = std::size_t{256} << 10U;

class Recorder {
 public:
  explicit Recorder(const RecordOptions& options)
      : options_(options),
        watcher_(options.wanted, options.trust,
                 [&options](std::string_view stream, std::string_view why, bool is_lost) {
                   if (is_lost || !options.quiet) say(fmt::format("'{}': {}", stream, why));
                 }),
        socket_(options.name),
        writer_(options.output, watcher_.clock()) {
    if (!options.quiet) {
      say(fmt::format("process {}: recording to {}{}", getpid(), options.output.path,
                      options.output.last ? ", from memory when an event occurs" : ""));
    }
  }

  OutputReport run() {
    const Time end = options_.duration ? clock_.now() + *options_.duration : Time::max();
    while (!stop_requested() && clock_.now() < end && !has_ended()) {
      watcher_.sweep(batch_);
      look_at_triggers();
      const Time now = clock_.now();
      if (batch_.bytes >= kBatchBytes || now >= next_put_) put(now);
      const Time pause = watcher_.next_pause();
      if (pause > Time::zero()) (void)sleep_until(std::min(now + pause, end));
    }
    watcher_.finish(batch_);
    put(clock_.now());
    return writer_.finish();
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  [[nodiscard]] bool has_ended() const noexcept {
    return options_.until_finished && watcher_.are_all_finished();
  }

  void put(Time now) {
    next_put_ = now + kBatch;
    if (batch_.records.empty() || writer_.put(batch_)) return;
    if (dropped_ == 0) say("the disk is too slow: records are dropped, and counted in the file");
    watcher_.note_dropped(batch_);
    dropped_ += batch_.records.size();
    batch_ = {.now = batch_.now};
  }

  void look_at_triggers() {
    const bool has_signal = take_trigger_signal();
    const Time now = clock_.now();
    if (!has_signal && now < next_trigger_) return;
    next_trigger_ = now + std::chrono::milliseconds(10);
    if (!socket_.take() && !has_signal) return;
    put(now);
    writer_.trigger();
  }

  const RecordOptions& options_;
  MonotonicClock clock_;
  Watcher watcher_;
  TriggerSocket socket_;
  WriterThread writer_;
  Batch batch_;
  Time next_put_{};
  Time next_trigger_{};
  std::uint64_t dropped_ = 0;
};

std::uint64_t count_of(const OutputReport& report, RecordKind kind) {
  const auto found = report.records.find(kind);
  return found != report.records.end() ? found->second : 0;
}

std::string in_words(const OutputReport& report, std::uint64_t dropped) {
  const auto s = [](std::uint64_t count) { return count == 1 ? "" : "s"; };
  std::string text = fmt::format(
      "{} items and {} segments recorded in {} file{}, {} bytes; {} records dropped, {} lost",
      count_of(report, RecordKind::item), count_of(report, RecordKind::segment),
      report.files.size(), s(report.files.size()), report.bytes, dropped, report.lost);
  if (report.further_events > 0) {
    text += fmt::format("; {} further event{} in these dumps", report.further_events,
                        s(report.further_events));
  }
  return text;
}

nlohmann::ordered_json to_json(const OutputReport& report, std::uint64_t dropped) {
  const auto count = [&](RecordKind kind) { return count_of(report, kind); };
  return {{"files", report.files},
          {"bytes", report.bytes},
          {"items", count(RecordKind::item)},
          {"segments", count(RecordKind::segment)},
          {"refusals", count(RecordKind::refusal)},
          {"events", count(RecordKind::event)},
          {"dropped", dropped},
          {"lost", report.lost},
          {"failures", report.failures},
          {"further_events", report.further_events}};
}

}  // namespace

int run_record(const RecordOptions& options) {
  if (!options.trigger.empty()) {
    send_trigger(options.trigger);
    return kOk;
  }
  mcap::require_mcap();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that has reached RLIMIT_FSIZE is an error of write(2)
  catch_trigger_signal();
  catch_stop_signals();
  raise_descriptor_limit();
  Recorder recorder(options);
  const OutputReport report = recorder.run();
  const auto json = to_json(report, recorder.dropped());
  if (options.json) {
    print_report(json.dump(2) + "\n");
  } else if (!options.quiet) {
    say(in_words(report, recorder.dropped()));
  }
  return report.lost + recorder.dropped() > 0 ? kFailed : kOk;
}

}  // namespace splinecast::apps::record
