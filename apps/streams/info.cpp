#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/contents/contents.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/streams/report.hpp"
#include "apps/streams/rows.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/roles/inspect.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

std::string text_of(const ordered_json& value) {
  return ipc::printable(value.is_string()
                            ? value.get<std::string>()
                            : value.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

/// Whether a value is 0, null or empty, or a list of such values. `false` is a value.
bool is_nothing(const ordered_json& value) {
  if (value.is_number()) return value == 0;
  if (value.is_string()) return value.get_ref<const std::string&>().empty();
  return !value.is_boolean() && std::ranges::all_of(value, is_nothing);
}

/// A table of values, without those that are nothing unless `all`. Counts those in `left_out`.
std::string table_of(const ordered_json& json, int indent, bool all, int& left_out) {
  std::string table;
  for (const auto& [key, value] : json.items()) {
    if (!all && is_nothing(value)) {
      ++left_out;
    } else if (value.is_object()) {
      table +=
          fmt::format("{:{}}{}\n", "", indent, key) + table_of(value, indent + 2, all, left_out);
    } else {
      table += fmt::format("{:{}}{:<{}}  {}\n", "", indent, key, 26 - indent, text_of(value));
    }
  }
  return table;
}

std::string table_of(const ordered_json& json, bool all) {
  int left_out = 0;
  std::string table = table_of(json, 0, all, left_out);
  if (left_out > 0) table += fmt::format("{:<26}  {} (--all)\n", "0 or empty", left_out);
  return table;
}

/// The time since the last publication, as text.
std::string age_of(const ipc::StreamInfo& info) {
  if (info.summary.revision == 0) return {};
  const double age = to_seconds(MonotonicClock().now() - info.summary.committed);
  return fmt::format("{:<26}  {:.3f} s ago\n", "last published", age);
}

/// Whether the argument is a file: it is `-` (standard input), contains a slash, or is the name of
/// a file and of no stream.
bool is_file(const std::string& name) {
  if (name.find('/') != std::string::npos || name == "-") return true;
  const auto has_region = [&](ipc::RegionKind kind) {
    return std::filesystem::exists(ipc::region_path(name, kind));
  };
  return !has_region(ipc::RegionKind::waypoints) && !has_region(ipc::RegionKind::spline) &&
         std::filesystem::is_regular_file(name);
}

void show_stream(const std::string& stream, const Trust& trust, bool as_json, bool all) {
  const ipc::StreamInfo info = ipc::inspect(stream, trust);
  ordered_json json = to_json(info);
  const std::string warning = depth_warning(info, trust);
  if (!warning.empty()) json["depth_warning"] = warning;
  print_report(as_json ? pretty(json) : table_of(json, all) + age_of(info));
}

void show_file(const std::string& path, bool only_events, bool as_json) {
  const FileContents contents = contents_of(path);
  print_report(as_json       ? pretty(to_json(contents))
               : only_events ? events_text(contents)
                             : to_text(contents));
}

void add_info(Command& verb, Action& action) {
  struct Options {
    std::string stream;
    bool events = false;
    bool json = false;
    bool all = false;
    Trust trust;
  };
  auto options = std::make_shared<Options>();
  verb.option("STREAM|FILE", options->stream,
              "Name of the stream to show, or path of a file of waypoints, an MCAP file or a ULog")
      .required();
  verb.flag("--events", options->events,
            "Of a recording: list the events instead, each with its wall clock");
  verb.flag("--all", options->all,
            "Of a stream: also show what is 0 or empty, which JSON always contains");
  verb.flag("--json", options->json, "Print JSON");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    action = [options] {
      if (is_file(options->stream)) {
        show_file(options->stream, options->events, options->json);
      } else {
        show_stream(options->stream, options->trust, options->json, options->all);
      }
      return kOk;
    };
  });
}

const Verb info_verb("info", 110,
                     "Show the state and the options of a stream, or what a file contains",
                     add_info);

}  // namespace

}  // namespace splinecast::apps
