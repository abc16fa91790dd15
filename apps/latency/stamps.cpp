#include "apps/latency/stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace splinecast::apps {
namespace {

/// Returns the first entry from `at` on for which `reached` holds, and moves `at` to it; nullptr if
/// there is none. Callers search for ascending targets, so all calls together make one pass over
/// the entries.
template <typename T, typename Reached>
const T* first_from(std::span<const T> entries, std::size_t& at, const Reached& reached) {
  while (at < entries.size() && !reached(entries[at])) ++at;
  return at < entries.size() ? &entries[at] : nullptr;
}

/// The stages append, solved, published, and one per reader, without latencies.
std::vector<Latencies> make_stages(std::size_t readers, const Measured& measured) {
  std::vector<Latencies> stages;
  stages.push_back(make_stage("append", measured));
  stages.push_back(make_stage("solved", measured));
  stages.push_back(make_stage("published", measured));
  for (std::size_t r = 0; r < readers; ++r) {
    stages.push_back(
        make_stage(readers == 1 ? "seen" : fmt::format("seen by reader {}", r), measured));
  }
  return stages;
}

}  // namespace

Latencies make_stage(std::string name, const Measured& measured) {
  return {.stage = std::move(name),
          .intended = {},
          .raw = {},
          .over_time = TimeGrid(measured.from, measured.until),
          .missed = 0,
          .missing = 0};
}

void add(Latencies& stage, const AppendStamp& append, Time reached, const Measured& measured) {
  const Time latency = reached - append.intended;
  stage.intended.record(latency);
  stage.raw.record(reached - append.begun);
  stage.over_time.record(append.intended, latency);
  if (latency > measured.deadline) ++stage.missed;
}

void add_missing(Latencies& stage) {
  ++stage.missing;
  ++stage.missed;
}

std::vector<Latencies> latencies_of(std::span<const AppendStamp> appends,
                                    std::span<const RevisionStamp> revisions,
                                    const std::vector<std::span<const SeenStamp>>& readers,
                                    std::span<const ipc::Word> refused, const Measured& measured) {
  std::vector<Latencies> stages = make_stages(readers.size(), measured);
  std::size_t revision_at = 0;
  std::vector<std::size_t> seen_at(readers.size());
  for (const AppendStamp& append : appends) {
    if (append.intended < measured.from || append.intended >= measured.until) continue;
    if (append.item == kRefusedItem) {
      std::ranges::for_each(stages, add_missing);
      continue;
    }
    add(stages[0], append, append.appended, measured);
    const RevisionStamp* const revision =
        std::ranges::binary_search(refused, append.item)
            ? nullptr
            : first_from(revisions, revision_at,
                         [&](const RevisionStamp& r) { return r.consumed > append.item; });
    if (revision == nullptr) {
      std::for_each(stages.begin() + 1, stages.end(), add_missing);
      continue;
    }
    add(stages[1], append, revision->solved, measured);
    add(stages[2], append, revision->published, measured);
    for (std::size_t r = 0; r < readers.size(); ++r) {
      const SeenStamp* const seen = first_from(readers[r], seen_at[r], [&](const SeenStamp& s) {
        return s.revision >= revision->revision;
      });
      if (seen == nullptr) {
        add_missing(stages[3 + r]);
      } else {
        add(stages[3 + r], append, seen->seen, measured);
      }
    }
  }
  return stages;
}

}  // namespace splinecast::apps
