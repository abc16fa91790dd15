#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/streams/holders.hpp"
#include "apps/streams/report.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/roles/inspect.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// The entry of a stream in the list; with the reason if the stream cannot be read.
ordered_json stream_entry(const std::string& stream, const Trust& trust) {
  try {
    return to_json(ipc::inspect(stream, trust));
  } catch (const NoSuchStream&) {
    return {{"stream", stream}, {"state", "waiting for a producer"}};
  } catch (const StreamError& error) {
    return {{"stream", stream}, {"state", "unusable"}, {"error", error.what()}};
  }
}

/// The same, with those who request to hold the stream.
ordered_json list_entry(const std::string& stream, bool exists, const Holders& holders,
                        const Trust& trust) {
  ordered_json entry = exists ? stream_entry(stream, trust)
                              : ordered_json{{"stream", stream}, {"state", "no stream"}};
  const auto own = holders.find(stream);
  entry["stopped_by"] = own != holders.end() ? own->second : std::vector<std::string>{};
  return entry;
}

std::string state_in_words(const ordered_json& entry) {
  std::string text = entry.contains("error") ? entry["error"].get<std::string>()
                                             : entry["state"].get<std::string>();
  const auto holders = entry["stopped_by"].get<std::vector<std::string>>();
  return holders.empty() ? text : text + "; stopped by " + quoted(holders);
}

std::string row(const ordered_json& entry) {
  const auto alive = [&](const char* role) {
    const bool exists = entry.contains(role) && entry[role].is_object();
    return !exists ? "-" : entry[role]["alive"].get<bool>() ? "alive" : "gone";
  };
  const bool solved = entry.contains("solver") && entry["solver"].is_object();
  return fmt::format("{:<24} {:>4} {:<9} {:<9} {:<7} {:>10}  {}\n",
                     entry["stream"].get<std::string>(),
                     entry.contains("dimensions") ? entry["dimensions"].dump() : "-",
                     entry.value("clock", "-"), alive("producer"), alive("solver"),
                     solved ? entry["solver"]["interpolated"].dump() : "-", state_in_words(entry));
}

int list_streams(bool as_json, const Trust& trust) {
  ordered_json list = ordered_json::array();
  const Holders holders = holders_by_stream(trust);
  const std::vector<std::string> names = stream_names();
  std::set<std::string> streams(names.begin(), names.end());
  for (const auto& [stream, own] : holders) streams.insert(stream);
  for (const std::string& stream : streams) {
    const bool exists = std::ranges::find(names, stream) != names.end();
    list.push_back(list_entry(stream, exists, holders, trust));
  }
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
