#include "apps/advise/report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/files/unit_of_name.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// One recommendation: its name in JSON and in text, its value and its reason.
struct Item {
  const char* key;
  const char* name;
  std::string value;
  std::string why;
};

/// Values of all dimensions, separated by commas as in options, with their unit if all share one.
std::string list_of(const std::vector<double>& values, const AdviceSource& source,
                    const char* per) {
  std::string text;
  const std::string unit = name_and_unit(source.columns.front()).second;
  bool is_common = !unit.empty();
  for (std::size_t d = 0; d < values.size(); ++d) {
    text += fmt::format("{}{:.3g}", text.empty() ? "" : ",", values[d]);
    is_common = is_common && name_and_unit(source.columns[d]).second == unit;
  }
  return is_common ? fmt::format("{} {}{}", text, ipc::printable(unit), per) : text;
}

std::string why_settle(const Advice& advice) {
  constexpr double kFading = 0.27;  // decay of a waypoint's effect per knot
  return fmt::format("{:.1g} of a change remains after {} knots",
                     std::pow(kFading, static_cast<double>(advice.how.settle)), advice.how.settle);
}

std::string why_freeze_ahead(const AdviceSource& source) {
  if (!source.solved) return "the default";
  if (!source.solved->was_late()) return "no revision was late";
  return fmt::format("doubled: {} deadline misses and {} late commits with {}",
                     source.solved->deadline_misses, source.solved->late_commits,
                     in_milliseconds(source.solved->how.settle_ahead));
}

std::vector<Item> items_of(const Advice& advice, const AdviceSource& source) {
  return {
      {"lead", "lead", in_milliseconds(advice.lead),
       lead_in_words(advice.intervals, advice.how, advice.lead)},
      {"settle", "settle lag K", fmt::format("{}", advice.how.settle), why_settle(advice)},
      {"freeze_ahead", "freeze-ahead", in_milliseconds(advice.how.settle_ahead),
       why_freeze_ahead(source)},
      {"stop_time", "stop time", in_milliseconds(advice.limits.stop_length),
       "a stop from peak velocity v takes 1.5 v/T, within the acceleration limits"},
      {"max_velocity", "velocity limits", list_of(advice.limits.velocity, source, "/s"),
       "3 times the 95 % values"},
      {"max_acceleration", "acceleration limits",
       list_of(advice.limits.acceleration, source, "/s^2"),
       "3 times the 95 % values; at least enough to stop within 1 s"},
  };
}

/// Warnings: gaps longer than the lead, and peaks that exceed the recommended limits.
std::vector<std::string> notes_of(const Advice& advice, const AdviceSource& source) {
  std::vector<std::string> notes;
  if (advice.intervals.longest_gap > advice.lead) {
    notes.push_back(fmt::format("the longest gap, {}, exceeds the lead: the stream starves there",
                                in_milliseconds(advice.intervals.longest_gap)));
  }
  for (std::size_t d = 0; d < advice.motion.size(); ++d) {
    const bool is_beyond = advice.motion[d].peak_velocity > advice.limits.velocity[d] ||
                           advice.motion[d].peak_acceleration > advice.limits.acceleration[d];
    if (!is_beyond) continue;
    notes.push_back(
        fmt::format("the peaks of {} exceed its limits", name_and_unit(source.columns[d]).first));
  }
  return notes;
}

ordered_json to_json(const Intervals& intervals) {
  return {{"median_ns", intervals.median.count()},
          {"p5_ns", intervals.p5.count()},
          {"p95_ns", intervals.p95.count()},
          {"largest_ns", intervals.largest.count()},
          {"jitter_ns", intervals.jitter.count()}};
}

ordered_json to_json(const DimensionMotion& motion, const std::string& column) {
  const auto [name, unit] = name_and_unit(column);
  return {{"name", name},
          {"unit", unit},
          {"noise", motion.noise},
          {"velocity", motion.velocity},
          {"peak_velocity", motion.peak_velocity},
          {"acceleration", motion.acceleration},
          {"peak_acceleration", motion.peak_acceleration}};
}

ordered_json to_json(const SilenceEffect& silence) {
  ordered_json return_time = ordered_json::array();
  for (const auto& seconds : silence.return_time) {
    return_time.push_back(seconds ? ordered_json(*seconds) : ordered_json());
  }
  return {{"lead_ns", silence.lead.count()},
          {"silence_ns", silence.silence.count()},
          {"depth_left_ns", silence.depth_left.count()},
          {"dry_ns", silence.dry.count()},
          {"comes_to_rest", silence.comes_to_rest},
          {"way_back_s", return_time}};
}

ordered_json solved_json(const AdviceSource& source) {
  if (!source.solved) return nullptr;
  const auto& [how, stop_length, low_water, deadline_misses, late_commits] = *source.solved;
  return {{"settle", how.settle},
          {"freeze_ahead_ns", how.settle_ahead.count()},
          {"stop_time_ns", stop_length.count()},
          {"low_water_ns", low_water ? ordered_json(low_water->count()) : ordered_json()},
          {"deadline_misses", deadline_misses},
          {"late_commits", late_commits}};
}

ordered_json late_json(const AdviceSource& source) {
  return {{"duplicate", source.duplicates}, {"out of order", source.out_of_order}};
}

ordered_json gaps_json(const Intervals& intervals) {
  return {{"longer_than_ns", intervals.gap_from().count()},
          {"count", intervals.gaps},
          {"longest_ns", intervals.longest_gap.count()}};
}

ordered_json advised_json(const Advice& advice) {
  return {{"lead_ns", advice.lead.count()},
          {"depth_needed_ns", advice.depth_needed.count()},
          {"settle", advice.how.settle},
          {"freeze_ahead_ns", advice.how.settle_ahead.count()},
          {"stop_time_ns", advice.limits.stop_length.count()},
          {"max_velocity", advice.limits.velocity},
          {"max_acceleration", advice.limits.acceleration}};
}

std::string intervals_in_words(const Advice& advice, const AdviceSource& source) {
  const Intervals& at = advice.intervals;
  std::string text =
      fmt::format("{:<15} median {}, 5 to 95 % {} to {}, at most {}; jitter {}\n", "intervals",
                  in_milliseconds(at.median), in_milliseconds(at.p5), in_milliseconds(at.p95),
                  in_milliseconds(at.largest), in_milliseconds(at.jitter));
  text += fmt::format("{:<15} {} duplicate, {} out of order\n", "late rows", source.duplicates,
                      source.out_of_order);
  text += fmt::format("{:<15} {} longer than {}", "gaps", at.gaps, in_milliseconds(at.gap_from()));
  if (at.gaps > 0) text += fmt::format(", at most {}", in_milliseconds(at.longest_gap));
  return text + "\n";
}

std::string solved_in_words(const AdviceSource& source) {
  if (!source.solved) return {};
  const auto& [how, stop_length, low_water, deadline_misses, late_commits] = *source.solved;
  return fmt::format(
      "{:<15} K = {}, freeze-ahead {}, stop time {}; least depth {}; {} deadline misses, "
      "{} late commits\n",
      "solver", how.settle, in_milliseconds(how.settle_ahead), in_milliseconds(stop_length),
      low_water ? in_milliseconds(*low_water) : "unknown", deadline_misses, late_commits);
}

std::string motion_in_words(const Advice& advice, const AdviceSource& source) {
  std::string text = fmt::format("{:<20} {:<12} {:>10} {:>12} {:>10} {:>12} {:>10}\n", "", "unit",
                                 "noise", "95 % /s", "peak /s", "95 % /s^2", "peak /s^2");
  for (std::size_t d = 0; d < advice.motion.size(); ++d) {
    const auto [name, unit] = name_and_unit(ipc::printable(source.columns[d]));
    const DimensionMotion& m = advice.motion[d];
    text += fmt::format("{:<20} {:<12} {:>10.3g} {:>12.3g} {:>10.3g} {:>12.3g} {:>10.3g}\n", name,
                        unit.empty() ? "-" : unit, m.noise, m.velocity, m.peak_velocity,
                        m.acceleration, m.peak_acceleration);
  }
  return text;
}

std::string return_time_in_words(const SilenceEffect& silence, const AdviceSource& source) {
  if (silence.dry == Time::zero()) return {};
  std::string text;
  for (std::size_t d = 0; d < silence.return_time.size(); ++d) {
    const auto& seconds = silence.return_time[d];
    text += fmt::format("{}{} {}", text.empty() ? "; time to return: " : ", ",
                        name_and_unit(ipc::printable(source.columns[d])).first,
                        seconds ? fmt::format("{:.2g} s", *seconds) : "never at its peak velocity");
  }
  return text;
}

}  // namespace

std::string in_milliseconds(Time t) { return fmt::format("{:.6g} ms", to_seconds(t) * 1e3); }

std::string lead_in_words(const Intervals& intervals, const SolvedHow& how, Time lead) {
  const Time depth = depth_needed(intervals.median, how);
  std::string why = fmt::format("freeze-ahead {} + {} intervals of {} = {}, and jitter of {}",
                                in_milliseconds(how.settle_ahead), how.settle + 1,
                                in_milliseconds(intervals.median), in_milliseconds(depth),
                                in_milliseconds(intervals.jitter));
  if (lead == kLeastLead) why += "; at least " + in_milliseconds(kLeastLead);
  if (lead < depth) why += "; at most the whole recording";
  return why;
}

std::string in_words(const SilenceEffect& silence) {
  if (silence.dry == Time::zero()) {
    return fmt::format("no effect: {} of depth remains", in_milliseconds(silence.depth_left));
  }
  return fmt::format("starves for {} and {}", in_milliseconds(silence.dry),
                     silence.comes_to_rest ? "comes to rest" : "does not come to rest");
}

ordered_json to_json(const Advice& advice, const AdviceSource& source) {
  ordered_json json{{"source", source.name},
                    {"rows", source.rows},
                    {"length_ns", source.length.count()},
                    {"intervals", to_json(advice.intervals)},
                    {"late", late_json(source)},
                    {"gaps", gaps_json(advice.intervals)},
                    {"solver", solved_json(source)},
                    {"dimensions", ordered_json::array()},
                    {"advice", advised_json(advice)},
                    {"why", ordered_json::object()},
                    {"hiccups", ordered_json::array()},
                    {"notes", notes_of(advice, source)}};
  for (std::size_t d = 0; d < advice.motion.size(); ++d) {
    json["dimensions"].push_back(to_json(advice.motion[d], source.columns[d]));
  }
  for (const Item& item : items_of(advice, source)) json["why"][item.key] = item.why;
  for (const SilenceEffect& silence : advice.silences) json["hiccups"].push_back(to_json(silence));
  return json;
}

std::string in_words(const Advice& advice, const AdviceSource& source) {
  std::string text = fmt::format("{}: {} rows, {:.6g} s\n\n", ipc::printable(source.name),
                                 source.rows, to_seconds(source.length));
  text += intervals_in_words(advice, source) + solved_in_words(source) + "\n";
  text += motion_in_words(advice, source) + "\n";
  for (const Item& item : items_of(advice, source)) {
    text += fmt::format("{:<20} {:<12} {}\n", item.name, item.value, item.why);
  }
  text += "\n";
  for (const SilenceEffect& silence : advice.silences) {
    text += fmt::format("silence of {}, lead {}: {}{}\n", in_milliseconds(silence.silence),
                        in_milliseconds(silence.lead), in_words(silence),
                        return_time_in_words(silence, source));
  }
  for (const std::string& note : notes_of(advice, source)) {
    text += fmt::format("note: {}\n", ipc::printable(note));
  }
  return text;
}

}  // namespace splinecast::apps
