#include "ipc/sweep/many_streams.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include "ipc/memory/names.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::ipc {
namespace {

/// Descriptors reserved for everything else that the process does.
constexpr std::size_t kOtherDescriptors = 32;

std::size_t most_streams(std::size_t descriptors_each) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const std::size_t all = limit.rlim_cur;
  return all > kOtherDescriptors ? (all - kOtherDescriptors) / descriptors_each : 0;
}

}  // namespace

StreamSweep::StreamSweep(const std::vector<std::string>& wanted, SolverOptions options,
                         NotifyNews notify, Time pause)
    : options_(std::move(options)),
      notify_(std::move(notify)),
      most_owned_(most_streams(kDescriptorsPerStream)),
      schedule_(pause) {
  for (const std::string& text : wanted) {
    if (is_pattern(text)) {
      patterns_.push_back(text);
      continue;
    }
    require_stream_name(text);
    members_[text].is_named = true;
  }
  Solver::require(options_);
  // Locks all named streams now; the sweeps attach to them one after the other.
  for (auto& [stream, member] : members_) {
    if (own(stream, member)) become(stream, member, State::waiting, SweepNews::waiting);
  }
}

/// Sets the state of a stream, and reports it if it has changed.
void StreamSweep::become(const std::string& stream, Member& member, State state, SweepNews news,
                         const Solver* solver, std::string_view why) noexcept {
  const bool is_news = member.state != state;
  member.state = state;
  if (is_news) notify(news, stream, solver, why);
}

void StreamSweep::notify(SweepNews news, const std::string& stream, const Solver* solver,
                         std::string_view why) noexcept {
  try {
    notify_(news, stream, solver, why);
  } catch (...) {
    return;  // a message that fails changes nothing for the streams
  }
}

std::size_t StreamSweep::owned() const noexcept {
  const auto waiting = std::ranges::count_if(
      members_, [](const auto& entry) { return entry.second.waiting != nullptr; });
  return served_.size() + static_cast<std::size_t>(waiting);
}

}  // namespace splinecast::ipc
