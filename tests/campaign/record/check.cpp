#include "tests/campaign/record/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/process/exit_codes.hpp"
#include "apps/record/format/bytes.hpp"

namespace splinecast::campaign::record {
namespace {

using nlohmann::json;

/// Whether a verification says that something of a stream is missing.
bool says_less(const json& stream) {
  const bool has_loss = std::ranges::any_of(stream["lost"], [](const json& n) { return n > 0; });
  return has_loss || stream["unverified"] > 0 || stream["unaccounted"] > 0;
}

std::uint64_t sum_of(const json& streams, const char* member) {
  std::uint64_t sum = 0;
  for (const json& stream : streams) sum += stream[member].get<std::uint64_t>();
  return sum;
}

}  // namespace

void RunCheck::run() {
  for (const std::string& path : folder_.recordings()) check_file(path);
  tidy(streams_);
  for (const auto& [key, stream] : streams_) {
    const auto sent = std::ranges::find_if(remains_.sent, [&key](const Sent& one) {
      return one.stream == key.first && one.id == key.second;
    });
    const bool is_known = sent != remains_.sent.end();
    check_stream(fmt::format("{} ({:x})", key.first, key.second), stream,
                 is_known ? &*sent : nullptr);
  }
  if (remains_.was_killed) return count_work();
  check_left();
  check_report();
  count_work();
}

void RunCheck::check_file(const std::string& path) {
  FileContents contents;
  try {
    contents = read_contents(path);
  } catch (const std::runtime_error& error) {
    return find("files that cannot be read", error.what());
  }
  tally_.count("files");
  if (contents.is_cut_off) tally_.count("files cut off");
  find("numbers twice in a file", path, contents.repeated);
  find("waypoints with other values", path, contents.wrong);
  check_verification(path, contents);
  add(streams_, contents.streams);
}

void RunCheck::check_verification(const std::string& path, const FileContents& contents) {
  Program program({"replay", "--verify", "--json", path}, path + ".verify");
  const int code = program.wait().value_or(apps::kFailed);
  if (code == apps::kBadUsageOrInput && contents.streams.empty()) {
    return tally_.count("files without a stream");
  }
  if (code != apps::kOk && code != apps::kIncomplete) {
    return find("files that do not verify",
                fmt::format("{}: exit code {}: {}{}", path, code, program.err(), program.out()));
  }
  const json streams = json::parse(program.out())["streams"];
  tally_.count("segments verified", sum_of(streams, "equal"));
  tally_.count("segments not verified", sum_of(streams, "unverified"));
  if (!remains_.was_killed) {
    find("items neither recorded nor lost", fmt::format("{}: {}", path, program.out()),
         sum_of(streams, "unaccounted"));
  }
  const bool is_less = sum_of(streams, "equal") == 0 || std::ranges::any_of(streams, says_less);
  if ((code == apps::kOk) == is_less || (code == apps::kOk && contents.losses > 0)) {
    find("verifications that do not say what is lost",
         fmt::format("{}: exit code {}: {}", path, code, program.out()));
  }
  if (contents.is_cut_off) check_recovered(path, streams);
}

void RunCheck::check_recovered(const std::string& path, const json& streams) {
  const std::string whole = path + ".whole";
  Program recover({"recover", path, "-o", whole}, path + ".recover");
  const int code = recover.wait().value_or(apps::kFailed);
  Program verify({"replay", "--verify", "--json", whole}, path + ".verify");
  const auto verified = verify.wait().value_or(apps::kFailed);
  const bool is_verified = verified == apps::kOk || verified == apps::kIncomplete;
  if (is_verified && json::parse(verify.out())["streams"] == streams) {
    return tally_.count("files recovered");
  }
  find("recovered files that differ", fmt::format("{}: exit codes {} and {}: {}{}", path, code,
                                                  verified, recover.err(), verify.err()));
}

void RunCheck::check_stream(const std::string& what, const StreamContents& stream,
                            const Sent* sent) {
  if (sent == nullptr) return find("counts that differ from the sender's", what + ": unknown");
  const std::uint64_t end = std::max(stream.items.recorded.end(), stream.items.lost.end());
  if (end > sent->items) {
    find("counts that differ from the sender's",
         fmt::format("{}: it has item {}, but {} were sent", what, end - 1, sent->items));
  }
  find("items both recorded and lost", what, stream.items.recorded.common(stream.items.lost));
  find("segments both recorded and lost", what,
       stream.segments.recorded.common(stream.segments.lost));
  if (remains_.was_killed) {
    check_gaps(what, "items", stream.items, std::nullopt);
    return check_gaps(what, "segments", stream.segments, std::nullopt);
  }
  if (!stream.account) {
    return find("accounts that differ from the files", what + ": none", has_all() ? 1 : 0);
  }
  const auto lost = stream.account->all_lost();
  check_numbers(what, "items", stream.items, stream.account->items, lost.items);
  check_numbers(what, "segments", stream.segments, stream.account->segments, lost.segments);
  if (!has_all() || !remains_.is_complete) return;
  check_sent(what, stream, *sent);
}

/// Compares the account of a stream with what its sender has counted.
void RunCheck::check_sent(const std::string& what, const StreamContents& stream, const Sent& sent) {
  const auto& account = *stream.account;
  // A solver that comes and goes while the recorder is paused is not seen.
  const bool is_seen = stream.has_solver && sent.segments;
  const std::uint64_t segments = is_seen ? *sent.segments : account.segments.end;
  if (sent.segments && !stream.has_solver) tally_.count("solvers that were not seen");
  if (account.items.end == sent.items && account.segments.end == segments) return;
  find("counts that differ from the sender's",
       fmt::format("{}: {} items and {} segments, but {} and {} were sent", what, account.items.end,
                   account.segments.end, sent.items, segments));
}

void RunCheck::check_numbers(const std::string& what, const std::string& unit,
                             const Numbers& numbers, const apps::record::Account::Numbers& account,
                             std::uint64_t lost) {
  const std::string text = fmt::format(
      "{}: {}: {} in files, {} lost in files; the account has {} of {}, {} lost and {} "
      "unwritten",
      what, unit, numbers.recorded.count(), numbers.lost.count(), account.recorded, account.end,
      lost, account.unwritten);
  const bool adds_up = account.recorded + account.unwritten + lost == account.end;
  const bool is_same = account.recorded == numbers.recorded.count() &&
                       lost == numbers.lost.count() && account.unwritten == 0;
  if (!adds_up || (has_all() && !is_same)) find("accounts that differ from the files", text);
  if (has_all()) check_gaps(text, unit, numbers, account.end);
}

/// Requires that each number below `end` is recorded or lost. `end` empty: up to the last one.
void RunCheck::check_gaps(const std::string& what, const std::string& unit, const Numbers& numbers,
                          std::optional<std::uint64_t> end) {
  Ranges all = numbers.recorded;
  all.add(numbers.lost);
  (void)all.tidy();
  find(unit + " neither recorded nor lost",
       fmt::format("{}: {}, from {} on", what, unit, all.first_missing()),
       all.missing(end.value_or(all.end())));
}

/// Each stream that still exists must be in a file, unless the one of its name before it is: the
/// recorder has not noticed then that this one has ended.
void RunCheck::check_left() {
  if (!has_all() || !remains_.is_complete) return;
  for (const Sent& sent : remains_.sent) {
    const bool is_known = std::ranges::any_of(
        streams_, [&sent](const auto& entry) { return entry.first.first == sent.stream; });
    if (sent.is_left && !is_known) {
      find("streams not recorded", fmt::format("{} ({:x})", sent.stream, sent.id));
    }
  }
}

void RunCheck::check_report() {
  if (!remains_.report.is_object()) return;
  std::uint64_t items = 0, segments = 0, lost_items = 0, lost_segments = 0, lost = 0, losses = 0;
  for (const auto& [key, stream] : streams_) {
    items += stream.items.recorded.count();
    segments += stream.segments.recorded.count();
    lost_items += stream.items.lost.count();
    lost_segments += stream.segments.lost.count();
    losses += stream.losses;
    lost += stream.account ? stream.account->all_lost().all() : 0;
  }
  const json& report = remains_.report;
  const bool is_same = report["items"] == items && report["segments"] == segments;
  const bool has_same_losses = report["lost_items"] == lost_items && report["lost"] == lost &&
                               report["lost_segments"] == lost_segments;
  if (!is_same || (has_all() && !has_same_losses)) {
    find("reports that differ from the files",
         fmt::format("the files have {} items and {} segments; {} items, {} segments and {} in all "
                     "are lost; the report: {}",
                     items, segments, lost_items, lost_segments, lost, report.dump()));
  }
  const bool is_lost = has_all() ? losses > 0 : report["lost"] > 0;
  if (remains_.code != (is_lost ? apps::kIncomplete : apps::kOk) || (losses > 0 && !is_lost)) {
    find("wrong exit codes", fmt::format("{}, and {} lost in the files; the report: {}",
                                         *remains_.code, losses, report.dump()));
  }
}

void RunCheck::count_work() {
  for (const auto& [key, stream] : streams_) {
    tally_.count("streams recorded");
    tally_.count("items recorded", stream.items.recorded.count());
    tally_.count("segments recorded", stream.segments.recorded.count());
  }
  for (const Sent& sent : remains_.sent) {
    tally_.count("streams sent");
    tally_.count("items sent", sent.items);
    if (!streams_.contains({sent.stream, sent.id})) tally_.count("streams in no file");
  }
  if (!remains_.report.is_object()) return;
  for (const auto& [reason, counts] : remains_.report["reasons"].items()) {
    for (const auto& [what, count] : counts.items()) {
      tally_.count(fmt::format("lost: {}", reason), count.get<std::uint64_t>());
    }
  }
}

}  // namespace splinecast::campaign::record
