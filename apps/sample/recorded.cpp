#include "apps/sample/recorded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "apps/output/samples.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/executed/executed_file.hpp"
#include "core/laws/motion.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps {
namespace {

using record::ExecutedCurve;
using record::ExecutedSample;

/// Where the curve of a file ends; excluded unless the stream is finished.
Time end_of(const ExecutedCurve& curve) {
  if (const auto* const open = curve.open()) return open->until;
  return curve.segments().back().right;
}

/// The first host time at which a law has reached a stream time, or its end in the file. Where the
/// file does not have the law, as before.
Time host_time(const ExecutedCurve& law, Time stream) {
  Time before = law.begin() - Time(1);
  Time after = end_of(law);
  while (after - before > Time(1)) {
    const Time middle = std::midpoint(before.count(), after.count()) * Time(1);
    const auto point = law_point(law, middle);
    (point && point->stream >= stream ? after : before) = middle;
  }
  return after;
}

/// The executed curve of a stream, by the time that its readers used.
class RecordedCurve {
 public:
  RecordedCurve(ExecutedCurve curve, std::optional<ExecutedCurve> law)
      : curve_(std::move(curve)), law_(std::move(law)) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return curve_.header().dimensions; }
  [[nodiscard]] DimensionKinds kinds() const { return ipc::dimension_kinds(curve_.header()); }

  [[nodiscard]] ExecutedSample sample(Time t, const StateRef& out) const noexcept {
    if (!law_) return curve_.sample(t, 0, t, out);
    const auto point = law_point(*law_, t);
    if (!point) {
      return {.status = t < law_->begin() ? SampleStatus::before_history : SampleStatus::no_data};
    }
    const ExecutedSample found = curve_.sample(point->stream, point->fraction, t, out);
    if (has_values(found.status)) core::follow(point->rates, out);
    return found;
  }

  [[nodiscard]] Time begin() const {
    return law_ ? std::max(law_->begin(), host_time(*law_, curve_.begin())) : curve_.begin();
  }
  [[nodiscard]] Time end() const {
    return law_ ? host_time(*law_, end_of(curve_)) : end_of(curve_);
  }

 private:
  ExecutedCurve curve_;
  std::optional<ExecutedCurve> law_;
};

/// Reads the curve and its law, and says which times it has.
RecordedCurve read_curve(const std::string& path, const std::string& name) {
  record::ExecutedStream stream = record::read_executed(path, name);
  record::say_what_is_missing(stream);
  if (stream.curve.is_empty()) {
    throw InputError(fmt::format("{}: stream '{}' has no settled segment", stream.file, name));
  }
  const ipc::RegionHeader& header = stream.curve.header();
  if (header.law_id == 0) return {std::move(stream.curve), std::nullopt};
  auto law = record::read_law(path, stream.curve);
  const std::string law_name = ipc::text_of(header.law);
  say(law ? fmt::format("'{}': times are host times, by the law '{}'", name, law_name)
          : fmt::format("'{}': times and derivatives are of stream time: the law '{}' is not in {}",
                        name, law_name, stream.file));
  return {std::move(stream.curve), std::move(law)};
}

/// The number of samples at a rate: those requested, or up to the end of the curve.
std::size_t count_of(const RecordedCurve& curve, const SampleOptions& options) {
  if (options.count > 0) return options.count;
  constexpr double kMost = 1e9;
  const double samples = std::floor(to_seconds(curve.end() - curve.begin()) * options.rate) + 1;
  if (samples <= kMost) return static_cast<std::size_t>(samples);
  throw InputError(fmt::format("--rate {} makes {:.0f} samples; the maximum is {:.0f}: use --count",
                               options.rate, samples, kMost));
}

}  // namespace

int sample_recording(const SampleOptions& options, const std::vector<Time>& times) {
  const RecordedCurve curve = read_curve(options.names.front(), options.names.back());
  Output output(options.output);
  SampleWriter writer(output, curve.dimensions(), curve.kinds(), "status,kind");
  State state(curve.dimensions());
  const State none = no_values(curve.dimensions());
  const auto write = [&](Time t) {
    if (stop_requested()) throw Interrupted("interrupted");
    const ExecutedSample found = curve.sample(t, state.ref());
    const bool is_there = has_values(found.status);
    writer.write(t, is_there ? state : none,
                 fmt::format("{},{}", to_string(found.status),
                             found.kind ? record::to_string(*found.kind) : ""));
  };
  for (const Time t : times) write(t);
  const std::size_t count = options.at.empty() ? count_of(curve, options) : 0;
  const Time begin = curve.begin();
  for (std::size_t k = 0; k < count; ++k) write(begin + period_times(k, options.rate));
  output.close();
  return kOk;
}

}  // namespace splinecast::apps
