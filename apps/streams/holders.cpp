#include "apps/streams/holders.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ipc/memory/region_watch.hpp"
#include "ipc/requests/stoppers.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps {

Holders holders_by_stream(const Trust& trust) {
  ipc::RegionWatch watch;
  watch.poll();
  Holders holders;
  for (const auto& [stream, names] : watch.stoppers().names()) {
    ipc::Stoppers stoppers(stream, trust, watch);
    stoppers.poll(MonotonicClock().now());
    for (const ipc::StopperState& state : stoppers.read()) {
      if (state.holds) holders[stream].push_back(state.name);
    }
  }
  return holders;
}

std::string quoted(const std::vector<std::string>& names) {
  return fmt::format("'{}'", fmt::join(names, "', '"));
}

}  // namespace splinecast::apps
