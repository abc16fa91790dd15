#include "apps/replay/lead.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "apps/advise/report.hpp"
#include "apps/process/messages.hpp"
#include "ipc/options/curve.hpp"

namespace splinecast::apps {
namespace {

/// Warns if a lead is less than K needs, and reports the effect of a silence of 100 ms.
void judge_lead(Time lead, Time needed, Time interval, const SolvedHow& how,
                const ReplayOptions& options, Time stop_length) {
  if (lead >= needed) return;
  const SilenceEffect effect = foresee(lead, std::chrono::milliseconds(100), interval,
                                       how.settle_ahead, {}, {.stop_length = stop_length});
  say(fmt::format("'{}': the lead of {} is less than the {} that K = {} needs; a silence of {}: {}",
                  options.stream, in_milliseconds(lead), in_milliseconds(needed), how.settle,
                  in_milliseconds(effect.silence), in_words(effect)));
}

}  // namespace

Time choose_lead(const Survey& survey, const ReplayOptions& options,
                 const ipc::RegionHeader& board) {
  const auto live = ipc::live_options(board);
  if (!live || !options.rate || survey.rows < 2) return options.lead.value_or(kLeastLead);
  const SolvedHow how{.settle = board.settle, .settle_ahead = live->settle_ahead};
  const Intervals& intervals = survey.intervals;
  const Time length = options.loops > 1 ? Time::max() : survey.last - survey.first;
  if (options.lead) {
    const Time needed = depth_needed(intervals.median, length, how);
    if (!options.quiet) {
      judge_lead(*options.lead, needed, intervals.median, how, options,
                 ipc::window_options(board).stop_length);
    }
    return *options.lead;
  }
  const Time lead = advised_lead(intervals, length, how);
  if (lead != kLeastLead && !options.quiet) {
    say(fmt::format("'{}': lead {}: {}", options.stream, in_milliseconds(lead),
                    lead_in_words(intervals, how, lead)));
  }
  return lead;
}

}  // namespace splinecast::apps
