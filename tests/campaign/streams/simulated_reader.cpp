#include "tests/campaign/streams/simulated_reader.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "ipc/board/reader.hpp"
#include "ipc/layout/board_control.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::size_t kExecutedKept = 8;
/// Probability that an offered sample replaces a random one of a full memory.
constexpr double kShareKept = 0.1;

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

std::string difference(std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!same_bits(a.subspan(i, 1), b.subspan(i, 1))) {
      return fmt::format("value {} was {} and is {}", i, a[i], b[i]);
    }
  }
  return "nothing";
}

}  // namespace

SampleMemory::SampleMemory(std::size_t size, std::size_t dimensions)
    : seen_(size, Seen{.time = {}, .values = std::vector<double>(4 * dimensions)}) {}

void SampleMemory::offer(Time t, const State& state, Random& random) {
  const bool is_full = used_ == seen_.size();
  if (is_full && !random.chance(kShareKept)) return;
  Seen& seen = seen_[is_full ? random.below(used_) : used_++];
  seen.time = t;
  std::ranges::copy(state.values(), seen.values.begin());
}

SimulatedReader::SimulatedReader(const ipc::KnotBoardReader& board, const StreamPlan& plan,
                                 RevisionLog& log, StreamFindings& findings, Random& random)
    : plan_(&plan),
      findings_(&findings),
      random_(&random),
      log_(&log),
      sampler_(board, StreamClock::monotonic, plan.kinds),
      state_(plan.dimensions.size()),
      again_(plan.dimensions.size()),
      executed_(kExecutedKept, plan.dimensions.size()) {}

SampleStatus SimulatedReader::sample(Time t, SampleMemory& settled) {
  const ipc::Word seen = sampler_.revision_seen();
  const SampleStatus status = sampler_.sample(t, state_.ref());
  note_revisions(seen);
  check_values(t, status, settled);
  if (!has_values(status)) return status;
  const bool is_revised = status == SampleStatus::revised;
  judge_revised(t, is_revised);
  if (!is_open_start(t)) executed_.offer(t, state_, *random_);
  if (!is_revised) read_executed_again();
  return status;
}

SampleStatus SimulatedReader::preview(Time t, SampleMemory& settled) {
  const ipc::Word seen = sampler_.revision_seen();
  const SampleStatus status = sampler_.preview(t, state_.ref());
  note_revisions(seen);
  check_values(t, status, settled);
  return status;
}

/// Whether t is before the start of the curve and the state at the start can still change: its
/// position if the method smooths, its velocity if the start condition is not at rest.
bool SimulatedReader::is_open_start(Time t) const {
  const bool is_fixed =
      is_at_rest(plan_->window.start.kind) && !plan_->window.interpolant.method->smooths();
  return !is_fixed && t < log_->start();
}

/// Notes whether one of the revisions since `seen` allows the status `revised`.
void SimulatedReader::note_revisions(ipc::Word seen) {
  const ipc::Word r = sampler_.revision_seen();
  if (r == seen) return;
  if (seen == 0) {
    settled_until_seen_ = sampler_.settled_until();
    return;
  }
  // A reader that missed many revisions may report `revised` for samples that had not settled.
  const bool is_careful = r - seen >= ipc::kChangesKept && sampled_until_ >= settled_until_seen_;
  may_be_revised_ = may_be_revised_ || is_careful || sampled_until_ >= log_->earliest(seen, r);
  settled_until_seen_ = sampler_.settled_until();
}

void SimulatedReader::judge_revised(Time t, bool is_revised) {
  if (is_revised && !may_be_revised_) {
    findings_->breach(Breach::false_revised,
                      fmt::format("at {}, sampled until {}, revision {}", t.count(),
                                  sampled_until_.count(), sampler_.revision_seen()));
  }
  may_be_revised_ = false;
  sampled_until_ = is_revised ? t : std::max(sampled_until_, t);
  if (is_revised) executed_.clear();
}

void SimulatedReader::read_executed_again() {
  const auto all = executed_.seen();
  if (all.empty()) return;
  const SampleMemory::Seen& seen = all[random_->below(all.size())];
  if (!has_values(sampler_.preview(seen.time, again_.ref()))) return;
  if (same_bits(again_.values(), seen.values)) return;
  findings_->breach(
      Breach::change_not_reported,
      fmt::format("sample at {}: {}, revision {}", seen.time.count(),
                  difference(seen.values, again_.values()), sampler_.revision_seen()));
  executed_.clear();
}

void SimulatedReader::check_values(Time t, SampleStatus status, SampleMemory& settled) {
  findings_->count(status);
  if (status == SampleStatus::busy || status == SampleStatus::retired) {
    findings_->breach(Breach::no_answer, fmt::format("{} at {}", to_string(status), t.count()));
  }
  if (!has_values(status)) return;
  has_read_ = has_read_ || !is_open_start(t);
  double sum = 0;
  for (const double value : state_.values()) sum += value * 0;
  if (sum != 0) {
    findings_->breach(Breach::not_finite, fmt::format("{} at {}", to_string(status), t.count()));
  }
  if (t < sampler_.settled_until() && !is_open_start(t)) settled.offer(t, state_, *random_);
}

void read_settled_again(const ipc::KnotBoardReader& board, const StreamPlan& plan,
                        const SampleMemory& settled, StreamFindings& findings) {
  ipc::Sampler fresh(board, StreamClock::monotonic, plan.kinds);
  State state(plan.dimensions.size());
  for (const SampleMemory::Seen& seen : settled.seen()) {
    const SampleStatus status = fresh.preview(seen.time, state.ref());
    if (status == SampleStatus::before_history) continue;
    findings.count(Event::settled_samples_read_again);
    if (has_values(status) && same_bits(state.values(), seen.values)) continue;
    findings.breach(Breach::settled_changed,
                    fmt::format("at {}: {}, {}", seen.time.count(), to_string(status),
                                difference(seen.values, state.values())));
    return;
  }
}

}  // namespace splinecast::campaign
