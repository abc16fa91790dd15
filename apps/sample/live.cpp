#include "apps/sample/live.hpp"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <vector>

#include "apps/output/samples.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/attach.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/reader.hpp"

namespace splinecast::apps {
namespace {

/// Samples one stream to a file. Attaches again if the stream is recreated.
class Sampling {
 public:
  Sampling(const SampleOptions& options, std::vector<Time> times)
      : options_(options),
        times_(std::move(times)),
        reader_(attach_reader(options.names.back(), options.wait, options.trust)),
        // With --rate others can follow the file while it grows.
        output_(options.output, options.at.empty() ? Writing::growing : Writing::whole),
        state_(reader_.dimensions()),
        none_(no_values(reader_.dimensions())),
        writer_(output_, reader_.dimensions(), reader_.kinds(), "status") {}

  int run() {
    const bool is_complete = write_all();
    output_.close();
    if (!is_complete) throw Interrupted("interrupted");
    return kOk;
  }

 private:
  /// Returns false if a stop is requested meanwhile, as the functions that it calls do.
  bool write_all() {
    if (!options_.at.empty()) {
      return std::ranges::all_of(times_, [this](Time t) { return write(t); });
    }
    return is_live(reader_.clock()) ? follow_live() : step_through_recording();
  }

  bool follow_live() {
    const Time start = clock_.now();
    for (std::size_t k = 0; k < options_.count; ++k) {
      const Time t = start + period_times(k, options_.rate);
      if (clock_.now() < t) output_.flush();  // others can read each line before the next one
      if (!sleep_until(t) || !write(t)) return false;
    }
    return true;
  }

  bool step_through_recording() {
    const Time start = first_knot();
    for (std::size_t k = 0; k < options_.count; ++k) {
      if (!write(start + period_times(k, options_.rate))) return false;
    }
    return true;
  }

  /// Time of the oldest knot that the board keeps.
  Time first_knot() {
    const Time end = deadline(clock_, options_.wait);
    for (;;) {
      if (const auto first = reader_.first_time()) return *first;
      if (stop_requested()) throw Interrupted("interrupted");
      if (clock_.now() >= end) {
        throw TimeOut(fmt::format("stream '{}' has no waypoints", options_.names.back()));
      }
      (void)reader_.wait(std::chrono::milliseconds(50));
    }
  }

  bool write(Time t) {
    if (stop_requested()) return false;
    const auto status = sample(t);
    if (!status) return false;
    writer_.write(t, has_values(*status) ? state_ : none_, to_string(*status));
    return true;
  }

  /// Samples at t. On a recorded stream, waits until the sample is final, or until nothing new has
  /// come for --wait. Returns nothing if a stop is requested meanwhile.
  std::optional<SampleStatus> sample(Time t) {
    Time end = deadline(clock_, options_.wait);
    for (;;) {
      const auto status = reader_.sample(t, state_);
      const bool has_answered = status != SampleStatus::retired && status != SampleStatus::busy;
      if (stop_requested() && !(has_answered && is_final(status))) return std::nullopt;
      if (status == SampleStatus::retired) {
        reattach();
        continue;
      }
      if (status == SampleStatus::busy && clock_.now() < end) {
        (void)reader_.wait(std::chrono::milliseconds(1));
        continue;
      }
      if (!patient_ || is_final(status)) return status;
      output_.flush();
      if (reader_.wait(std::chrono::milliseconds(20)) == WaitStatus::advanced) {
        end = deadline(clock_, options_.wait);
      } else if (clock_.now() >= end) {
        patient_ = false;
        say(fmt::format("stream '{}': nothing new for {} s; samples from {} ns on are not settled",
                        options_.names.back(), to_seconds(options_.wait), t.count()));
      }
    }
  }

  [[nodiscard]] bool is_final(SampleStatus status) const {
    if (is_live(reader_.clock())) return true;
    if (status == SampleStatus::settled || status == SampleStatus::before_history) {
      return true;
    }
    ipc::Summary summary;
    return ipc::Internals::summary(reader_, summary) && summary.finished;
  }

  void reattach() {
    const auto dimensions = ipc::dimensions_of(ipc::Internals::header(reader_));
    reader_ = attach_reader(options_.names.back(), options_.wait, options_.trust);
    if (reader_.dimensions() != dimensions.size()) {
      throw Failure(fmt::format("stream '{}' was recreated with {} dimensions, not {}",
                                options_.names.back(), reader_.dimensions(), dimensions.size()));
    }
    if (ipc::dimensions_of(ipc::Internals::header(reader_)) == dimensions) return;
    throw Failure(
        fmt::format("stream '{}' was recreated with other dimension kinds", options_.names.back()));
  }

  const SampleOptions& options_;
  std::vector<Time> times_;  ///< of --at
  MonotonicClock clock_;
  Reader reader_;
  Output output_;
  State state_;
  State none_;
  SampleWriter writer_;
  bool patient_ = true;  ///< whether to wait for samples that are not settled
};

}  // namespace

int sample_stream(const SampleOptions& options, std::vector<Time> times) {
  return Sampling(options, std::move(times)).run();
}

}  // namespace splinecast::apps
