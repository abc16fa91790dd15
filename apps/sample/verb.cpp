#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/file.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/executed/exact_messages.hpp"
#include "apps/sample/live.hpp"
#include "apps/sample/recorded.hpp"
#include "apps/tables/waypoints.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {
namespace {

/// The last sample's time must be in range.
void require_span(const SampleOptions& options) {
  if (options.count == 0) return;
  const double seconds = static_cast<double>(options.count - 1) / options.rate;
  const double most = to_seconds(kLongestTime);
  if (seconds <= most) return;
  throw UsageError("--count", fmt::format("{} samples at {} Hz take {} s; the maximum is {} s",
                                          options.count, options.rate, seconds, most));
}

bool is_of_file(const SampleOptions& options) { return options.names.size() == 2; }

/// Two names are a recording and a stream in it.
void require_recording(const SampleOptions& options) {
  if (!is_of_file(options)) return;
  const std::string& file = options.names.front();
  if (record::is_recording(file)) return;
  throw InputError(
      fmt::format("{}: it is not a recording of 'record', as the first of two names must be",
                  ipc::printable(file)));
}

int run_sample(const SampleOptions& options) {
  require_recording(options);
  require_separate(
      std::array{options.output},
      std::array{options.at, is_of_file(options) ? options.names.front() : std::string{}});
  // Read the times before the output is opened: here a signal still ends the process at once.
  auto times = options.at.empty() ? std::vector<Time>{}
                                  : read_times(options.at, {.time_unit = options.time_unit});
  catch_stop_signals();
  return is_of_file(options) ? sample_recording(options, times)
                             : sample_stream(options, std::move(times));
}

void require_consistent(const SampleOptions& options, bool has_times, bool lacks_count) {
  if (options.names.size() > 2) {
    throw UsageError("STREAM", "one name is a stream, two are a recording and a stream in it");
  }
  if (!has_times && options.rate == 0) {
    throw UsageError("sample", "needs --at, or --rate with --count");
  }
  if (lacks_count && !is_of_file(options)) throw UsageError("--rate", "needs --count");
  require_span(options);
}

void add_sample(Command& verb, Action& action) {
  auto options = std::make_shared<SampleOptions>();
  verb.option("STREAM", options->names,
              "Name of the stream to read; with two names, a recording that 'record' wrote, and a "
              "stream in it")
      .required();
  const Argument at =
      verb.option("--at", options->at, "File with a time column: times at which to sample")
          .type("FILE");
  Argument rate = verb.option(
      "--rate",
      [options](const std::string& text) { options->rate = number_within("--rate", text); },
      "Sampling rate in Hz, 1e-6 to 1e9; needs --count, except of a recording");
  rate.type("HZ");
  Argument count =
      add_count(verb, "--count", options->count,
                "Number of samples, from 1; needs --rate (default: to the end of the recording)");
  rate.excludes(at);
  count.needs(rate);
  verb.option("-o,--output", options->output, "Output file (default: standard output)").type("OUT");
  const Argument wait = add_seconds(
      verb, "--wait", options->wait,
      "Time in s to wait for the stream and, on a recorded stream, for new settled samples, "
      "from 0 (default 10)");
  add_time_unit(verb, options->time_unit);
  add_trust(verb, options->trust);
  verb.callback([&action, options, at, rate, count, wait] {
    require_consistent(*options, at.is_given(), rate.is_given() && !count.is_given());
    if (wait.is_given() && is_of_file(*options)) {
      throw UsageError("--wait", "a recording is not waited for");
    }
    action = [options] { return run_sample(*options); };
  });
}

const Verb sample_verb("sample", 40, "Sample the curve of a stream and write CSV", add_sample);

}  // namespace

}  // namespace splinecast::apps
