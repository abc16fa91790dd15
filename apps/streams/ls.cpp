#include <fmt/format.h>

#include <memory>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/streams/report.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/roles/inspect.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// The entry of a stream in the list; with the reason if the stream cannot be read.
ordered_json list_entry(const std::string& stream, const Trust& trust) {
  try {
    return to_json(ipc::inspect(stream, trust));
  } catch (const NoSuchStream&) {
    return {{"stream", stream}, {"state", "waiting for a producer"}};
  } catch (const StreamError& error) {
    return {{"stream", stream}, {"state", "unusable"}, {"error", error.what()}};
  }
}

std::string row(const ordered_json& entry) {
  const auto alive = [&](const char* role) {
    const bool stands = entry.contains(role) && entry[role].is_object();
    return !stands ? "-" : entry[role]["alive"].get<bool>() ? "alive" : "gone";
  };
  const bool solved = entry.contains("solver") && entry["solver"].is_object();
  return fmt::format(
      "{:<24} {:>4} {:<9} {:<9} {:<7} {:>10}  {}\n", entry["stream"].get<std::string>(),
      entry.contains("dimensions") ? entry["dimensions"].dump() : "-", entry.value("clock", "-"),
      alive("producer"), alive("solver"), solved ? entry["solver"]["interpolated"].dump() : "-",
      entry.contains("error") ? entry["error"].get<std::string>()
                              : entry["state"].get<std::string>());
}

int list_streams(bool as_json, const Trust& trust) {
  ordered_json list = ordered_json::array();
  for (const std::string& stream : stream_names()) list.push_back(list_entry(stream, trust));
  if (as_json) {
    print_report(pretty(list));
    return kOk;
  }
  std::string table = fmt::format("{:<24} {:>4} {:<9} {:<9} {:<7} {:>10}  {}\n", "STREAM", "DIMS",
                                  "CLOCK", "PRODUCER", "SOLVER", "WAYPOINTS", "STATE");
  for (const ordered_json& entry : list) table += row(entry);
  print_report(table);
  return kOk;
}

void add_ls(Command& verb, Action& action) {
  struct Options {
    bool json = false;
    Trust trust;
  };
  auto options = std::make_shared<Options>();
  verb.flag("--json", options->json, "Print JSON");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    action = [options] { return list_streams(options->json, options->trust); };
  });
}

const Verb ls_verb("ls", 100, "List the streams of this host", add_ls);

}  // namespace

}  // namespace splinecast::apps
