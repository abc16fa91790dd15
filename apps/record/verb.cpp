#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/files/numbers.hpp"
#include "apps/record/recorder.hpp"
#include "apps/record/trigger/address.hpp"
#include "apps/record/watch/events.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {
namespace {

constexpr TimeRange kLast{Time(1), std::chrono::hours(24)};
constexpr NumberRange kStatesRange{1e-3, 1e5};

/// A size in bytes, with a suffix KiB, MiB, GiB or none.
std::uint64_t size_within(const std::string& name, const std::string& text) {
  constexpr std::uint64_t kLeast = std::uint64_t{1} << 20U;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 50U;
  std::string_view digits = text;
  unsigned shift = 0;
  for (const auto& [suffix, bits] :
       {std::pair<std::string_view, unsigned>{"KiB", 10}, {"MiB", 20}, {"GiB", 30}}) {
    if (!digits.ends_with(suffix)) continue;
    digits.remove_suffix(suffix.size());
    shift = bits;
    break;
  }
  const auto count = parse_count(digits);
  const bool fits = count && *count <= kMost >> shift && *count << shift >= kLeast;
  if (!fits) throw UsageError(name, fmt::format("'{}' is not a size from 1MiB to 1024TiB", text));
  return *count << shift;
}

void add_memory(Command& verb, RecordOptions& options) {
  auto last = verb.option(
      "--last",
      [&options](const std::string& text) {
        options.output.last = time_within("--last", text, TimeUnit::seconds, kLast);
      },
      "Keep this many seconds in memory, and write them to a file of their own when an event of "
      "--on occurs, on SIGUSR1, on --trigger, and at the end. What is only in memory is lost with "
      "the process");
  last.type("SECONDS");
  verb.option("--on", Command::TakeList([&options](const std::vector<std::string>& names) {
                for (const std::string& name : names) {
                  const auto kind = parse_trigger(name);
                  if (!kind) {
                    throw UsageError("--on",
                                     fmt::format("'{}' is not one of {}", name, trigger_names()));
                  }
                  options.output.on.insert(*kind);
                }
              }),
              "With --last: events that write the memory, separated by commas: underrun, deadline, "
              "late, refusal, takeover, limit. Events that follow soon are in the same file")
      .type("EVENT,…")
      .separated_by_commas()
      .needs(last);
  add_seconds(verb, "--after", options.output.after,
              "With --last: time in s after the event until the file ends, from 0 (default 0)")
      .needs(last);
}

void add_files(Command& verb, RecordOptions& options) {
  verb.option(
          "--compression",
          [&options](const std::string& text) {
            const auto found = mcap::compression_of(text == "none" ? "" : text);
            if (!found) {
              throw UsageError("--compression",
                               fmt::format("'{}' is not one of zstd, lz4, none", text));
            }
            options.output.file.compression = *found;
          },
          "Compression of the file (default zstd)")
      .type("zstd|lz4|none");
  verb.option(
          "--states",
          [&options](const std::string& text) {
            const bool is_off = parse_number(text) == 0.0;
            options.output.file.states = {
                .hz = is_off ? 0 : number_within("--states", text, kStatesRange)};
          },
          "Rate of the states, which are the settled curve, in Hz, 1e-3 to 1e5; 0: none (default "
          "20)")
      .type("HZ");
  verb.option(
          "--max-size",
          [&options](const std::string& text) {
            options.output.max_bytes = size_within("--max-size", text);
          },
          "Begin another file when one has this size: bytes, or a number with KiB, MiB or GiB; at "
          "least 1MiB. A file may become larger by the data of about a second")
      .type("SIZE");
  add_count(verb, "--max-files", options.output.max_files,
            "Keep at most this many files of this recorder, 1 to 1e6: removes the oldest one",
            {1, 1'000'000});
}

/// Throws UsageError for a missing or invalid argument, or options that exclude one another.
void require_agreeing(const RecordOptions& options) {
  if (options.trigger.empty()) {
    if (options.wanted.empty()) throw UsageError("STREAM", "is required");
    if (options.output.path.empty()) throw UsageError("--output", "is required");
  }
  if (options.until_finished && std::ranges::any_of(options.wanted, &ipc::is_pattern)) {
    throw UsageError("--until-finished", "needs the names of the streams, not patterns");
  }
  if (!options.name.empty() && !is_recorder_name(options.name)) {
    throw UsageError("--name", fmt::format("'{}' is not a name of a recorder", options.name));
  }
}

void add_record(Command& verb, Action& action) {
  auto options = std::make_shared<RecordOptions>();
  verb.option(
      "STREAM", options->wanted,
      "Streams to record: names, and patterns such as 'arm.*', which also match streams that "
      "appear later");
  verb.option("-o,--output", options->output.path,
              "File to write, such as run.mcap; it must not exist. With --last, --max-size or "
              "--max-files the names of the files have a number, and that of a dump its event")
      .type("FILE");
  add_memory(verb, *options);
  add_files(verb, *options);
  add_seconds(verb, "--duration", options->duration, "Time in s after which to end, from 0");
  verb.flag("--until-finished", options->until_finished,
            "End when every stream is finished and has been recorded; not with patterns");
  verb.option("--name", options->name,
              "Name of this recorder for --trigger: 1 to 64 characters of A-Z a-z 0-9 . _ -, not "
              "only digits")
      .type("NAME");
  verb.option(
          "--trigger", options->trigger,
          "Trigger the recorder with this process id or name, and end: with --last it writes its "
          "memory, else it begins another file. Prints the name of the file when it has begun")
      .type("PID|NAME");
  verb.flag("--json", options->json, "Print JSON");
  verb.flag("--quiet", options->quiet, "Print no messages except failures");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    require_agreeing(*options);
    action = [options] { return run_record(*options); };
  });
}

const Verb record_verb("record", 35, "Record streams to MCAP files", add_record);

}  // namespace

}  // namespace splinecast::apps::record
