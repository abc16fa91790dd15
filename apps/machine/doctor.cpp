#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/machine/checks.hpp"
#include "apps/machine/facts.hpp"
#include "apps/machine/left_names.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/streams/report.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/old_motion.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

struct DoctorOptions {
  std::optional<std::string> stream;
  bool json = false;
  bool clean = false;
};

std::string_view to_string(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::note:
      return "note";
    case Verdict::unknown:
      return "unknown";
    case Verdict::problem:
      break;
  }
  return "problem";
}

/// Bytes of one more stream of seven dimensions with default options.
std::size_t bytes_of_default_stream() {
  constexpr std::size_t kDimensions = 7;
  constexpr std::size_t kRing = 1024;
  constexpr std::size_t kBoard = 4096;
  return ipc::RingLayout::of(kDimensions, kRing, ipc::kHeaderBytes).bytes +
         ipc::BoardLayout::of(kDimensions, kBoard, ipc::kHeaderBytes, false).bytes;
}

Finding finding_of(const LeftName& name) {
  const std::string check = fmt::format("stream {}", name.stream);
  switch (name.state) {
    case NameState::living:
      return {.check = check, .means = "has a living writer"};
    case NameState::dead:
      return {.check = check,
              .verdict = Verdict::note,
              .means = fmt::format("its writers have ended; {} bytes remain", name.bytes),
              .fix = fmt::format("splinecast doctor {} --clean", name.stream)};
    case NameState::foreign:
      return {.check = check,
              .verdict = Verdict::note,
              .means = name.why + ": not changed",
              .fix = "that user can remove it; readers give the user's name with --owner"};
    case NameState::unknown:
      return {.check = check,
              .verdict = Verdict::note,
              .means = name.why + ": not changed",
              .fix = "correct this, then run splinecast doctor again"};
    case NameState::hostile:
      break;
  }
  return {.check = check,
          .verdict = Verdict::problem,
          .means = name.why + ": it is neither used nor removed, and blocks the name",
          .fix = "find the process that created it, then remove it manually"};
}

/// Removes a stream whose owners are proven dead; an error becomes the finding.
Finding clean(const LeftName& name) {
  const std::string check = fmt::format("stream {}", name.stream);
  try {
    const Time end = ipc::end_of_motion(name.stream, {});
    const Time now = MonotonicClock().now();
    if (end > now && end - now <= ipc::kLongestOldMotion) {
      return {
          .check = check,
          .means = fmt::format("its writers have ended; not removed, because it moves for {:.1f} s",
                               to_seconds(end - now))};
    }
    remove_stream(name.stream);
    return {.check = check,
            .means = fmt::format("its writers had ended: removed ({} bytes)", name.bytes)};
  } catch (const NoSuchStream&) {
    return {.check = check, .means = "another process removed it"};
  } catch (const StreamBusy& error) {
    return {.check = check, .means = error.what()};
  } catch (const StreamError& error) {
    return {.check = check,
            .verdict = Verdict::problem,
            .means = error.what(),
            .fix = "find the process that created it, then remove it manually"};
  }
}

/// The state of a name; nullopt if its stream was removed meanwhile.
std::optional<LeftName> look(const std::string& stream) {
  try {
    return look_at_name(stream);
  } catch (const NoSuchStream&) {
    return std::nullopt;
  } catch (const StreamError& error) {
    return LeftName{.stream = stream, .state = NameState::unknown, .why = error.what()};
  }
}

std::vector<LeftName> names_to_look_at(const DoctorOptions& options) {
  if (options.stream) return {look_at_name(*options.stream)};
  std::vector<LeftName> names;
  for (const std::string& stream : stream_names()) {
    if (auto name = look(stream)) names.push_back(std::move(*name));
  }
  return names;
}

/// The header of a stream's ring; nullopt if it cannot be read, because the name has changed
/// meanwhile.
std::optional<ipc::RegionHeader> peek(const std::string& stream) {
  try {
    return ipc::peek_header(stream, ipc::RegionKind::waypoints, {});
  } catch (const StreamError&) {
    return std::nullopt;
  }
}

/// A finding if a live stream uses another clock than this process; else nullopt.
std::optional<Finding> clock_finding(const std::string& stream) {
  const auto header = peek(stream);
  if (!header || header->magic != ipc::kMagic) return std::nullopt;
  try {
    ipc::require_same_clock(*header, stream);
    return std::nullopt;
  } catch (const BadRegion& error) {
    return Finding{.check = fmt::format("time namespace of {}", stream),
                   .verdict = Verdict::problem,
                   .means = error.what(),
                   .fix = "run producer, solver and readers in one time namespace"};
  }
}

std::vector<Finding> examine(const DoctorOptions& options) {
  std::vector<Finding> of_names;
  std::size_t mapped = 0;
  for (const LeftName& name : names_to_look_at(options)) {
    const bool own = name.state == NameState::living || name.state == NameState::dead;
    const bool goes = options.clean && name.state == NameState::dead;
    of_names.push_back(goes ? clean(name) : finding_of(name));
    if (!own || goes) continue;
    mapped += name.bytes;
    if (auto clock = clock_finding(name.stream)) of_names.push_back(std::move(*clock));
  }
  auto findings = check_machine(read_machine(), bytes_of_default_stream(),
                                std::max(mapped, bytes_of_default_stream()));
  findings.insert(findings.end(), of_names.begin(), of_names.end());
  return findings;
}

std::string in_words(const Finding& finding) {
  std::string text =
      fmt::format("{:<8} {:<20} {}\n", to_string(finding.verdict), finding.check, finding.means);
  if (!finding.fix.empty()) text += fmt::format("{:<29} -> {}\n", "", finding.fix);
  return text;
}

ordered_json to_json(const Finding& finding) {
  return {{"check", finding.check},
          {"verdict", to_string(finding.verdict)},
          {"means", finding.means},
          {"mend", finding.fix}};
}

int run_doctor(const DoctorOptions& options) {
  const std::vector<Finding> findings = examine(options);
  const auto problems = std::ranges::count(findings, Verdict::problem, &Finding::verdict);
  if (options.json) {
    ordered_json list = ordered_json::array();
    for (const Finding& finding : findings) list.push_back(to_json(finding));
    print_report(pretty({{"problems", problems}, {"findings", list}}));
  } else {
    std::string text;
    for (const Finding& finding : findings) text += in_words(finding);
    print_report(text);
  }
  return problems == 0 ? kOk : kFailed;
}

void add_doctor(Command& verb, Action& action) {
  auto options = std::make_shared<DoctorOptions>();
  verb.option("STREAM", options->stream, "Examine this stream only (default: all)");
  verb.flag("--clean", options->clean, "Remove streams whose writers are proven dead");
  verb.flag("--json", options->json, "Print JSON");
  verb.callback([&action, options] { action = [options] { return run_doctor(*options); }; });
}

const Verb doctor_verb(
    "doctor", 130, "Check this machine's limits, report fixes, and find streams of dead writers",
    add_doctor);

}  // namespace

}  // namespace splinecast::apps
