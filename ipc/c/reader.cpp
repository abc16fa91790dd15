#include <optional>
#include <string>

#include "ipc/arguments/excess.hpp"
#include "ipc/arguments/options.hpp"
#include "ipc/arguments/states.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/c/roles.hpp"
#include "ipc/roles/internals.hpp"

using namespace splinecast;
using namespace splinecast::ipc;

namespace {

/// Runs the body of a function with the reader of a handle.
template <typename Body>
int with(splinecast_reader* reader, const Body& body) noexcept {
  return guarded([&] { return body(require_handle(reader, "reader")); });
}

Dimension dimension_of(const Reader& reader, std::size_t d) {
  const RegionHeader& header = Internals::header(reader);
  return {.kind = static_cast<DimensionKind>(header.dimension_kind[d]), .period = header.period[d]};
}

std::size_t require_dimension(std::size_t dimension, const splinecast_reader& own) {
  if (dimension >= own.reader.dimensions()) {
    refuse("dimension", "is " + std::to_string(dimension) + ", and the stream has " +
                            std::to_string(own.reader.dimensions()));
  }
  return dimension;
}

/// A text of a dimension, out of a list that has none or one for each.
const char* text(splinecast_reader* reader, std::size_t dimension,
                 std::vector<std::string> splinecast_reader::*list) noexcept {
  return guarded_text([&] {
    const splinecast_reader& own = require_handle(reader, "reader");
    const std::size_t d = require_dimension(dimension, own);
    const auto& texts = own.*list;
    return d < texts.size() ? texts[d].c_str() : "";
  });
}

int sample_at(splinecast_reader* reader, int64_t t, const splinecast_state* out,
              SampleStatus (Reader::*evaluate)(Time, const StateRef&) noexcept) noexcept {
  return with(reader, [&](splinecast_reader& own) {
    const StateTarget target(out, own.reader.dimensions());
    const SampleStatus status = (own.reader.*evaluate)(Time(t), target.ref());
    if (has_values(status)) target.put();
    return static_cast<int>(status);
  });
}

splinecast_vector vector_of(const std::vector<double>& values) noexcept {
  if (values.empty()) return {nullptr, 0, 0};
  return {values.data(), values.size(), 1};
}

}  // namespace

splinecast_reader::splinecast_reader(const std::string& stream, Time timeout, const Trust& trust,
                                     std::size_t many)
    : reader(stream, timeout, trust),
      names(reader.names()),
      units(reader.units()),
      times(many),
      statuses(many),
      values(many * 4 * reader.dimensions()),
      sampled(reader.dimensions()) {
  for (std::size_t d = 0; d < reader.dimensions(); ++d) {
    kinds.push_back(to_string(dimension_of(reader, d)));
  }
}

extern "C" {

int splinecast_reader_create(const char* stream, int64_t timeout,
                             const splinecast_reader_options* options, splinecast_reader** out) {
  return create_handle(out, [&] {
    constexpr std::size_t kMostTimes = std::size_t{1} << 20U;
    const auto all = read_optional(options, SPLINECAST_READER_OPTIONS_INIT, "options");
    if (all.times > kMostTimes) {
      refuse("options->times", "is " + std::to_string(all.times) + ", more than 2^20");
    }
    return new splinecast_reader(std::string(require_text(stream, "stream")), timeout_of(timeout),
                                 trust_of(all.owner, "options->owner"), all.times);
  });
}

int splinecast_reader_destroy(splinecast_reader* reader) {
  return destroy_handle(reader, "reader");
}

int splinecast_reader_dimensions(splinecast_reader* reader) {
  return with(reader,
              [](splinecast_reader& own) { return static_cast<int>(own.reader.dimensions()); });
}

int splinecast_reader_sample(splinecast_reader* reader, int64_t t, const splinecast_state* out) {
  return sample_at(reader, t, out, &Reader::sample);
}

int splinecast_reader_preview(splinecast_reader* reader, int64_t t, const splinecast_state* out) {
  return sample_at(reader, t, out, &Reader::preview);
}

int splinecast_reader_rate(splinecast_reader* reader, splinecast_law_rate* out) {
  return with(reader, [&](splinecast_reader& own) {
    const LawRate rate = own.reader.rate();
    *require_pointer(out, "out") = {
        .stream_time = rate.stream_time.count(), .rate = rate.rate, .slope = rate.slope};
    return 0;
  });
}

int splinecast_reader_settled_until(splinecast_reader* reader, int64_t* time) {
  return with(reader, [&](splinecast_reader& own) {
    *require_pointer(time, "time") = own.reader.settled_until().count();
    return 0;
  });
}

int splinecast_reader_limits(splinecast_reader* reader, splinecast_limits* out) {
  return with(reader, [&](splinecast_reader& own) {
    require_size(out, sizeof(splinecast_limits), "out");
    const MotionLimits& limits = own.reader.limits();
    write_struct({.size = sizeof(splinecast_limits),
                  .velocity = vector_of(limits.velocity),
                  .acceleration = vector_of(limits.acceleration),
                  .jerk = vector_of(limits.jerk),
                  .lower = vector_of(limits.lower),
                  .upper = vector_of(limits.upper)},
                 out);
    return 0;
  });
}

int splinecast_reader_excess(splinecast_reader* reader, const splinecast_state* sampled,
                             splinecast_excess* out) {
  return with(reader, [&](splinecast_reader& own) {
    require_pointer(out, "out");
    read_state(sampled, own.sampled);
    *out = excess_of(own.reader.excess(own.sampled));
    return 0;
  });
}

int splinecast_reader_progress(splinecast_reader* reader, splinecast_progress* out) {
  return with(reader, [&](splinecast_reader& own) {
    require_size(out, sizeof(splinecast_progress), "out");
    const std::optional<CurveProgress> progress = own.reader.progress();
    if (!progress) return 0;
    write_struct({.size = sizeof(splinecast_progress),
                  .revision = progress->revision,
                  .newest = progress->newest.count(),
                  .settled_until = progress->settled_until.count(),
                  .waypoints = progress->waypoints,
                  .refused = progress->refused,
                  .is_finished = progress->is_finished ? 1 : 0,
                  .reserved = 0},
                 out);
    return 1;
  });
}

int splinecast_reader_first_time(splinecast_reader* reader, int64_t* time) {
  return with(reader, [&](splinecast_reader& own) {
    require_pointer(time, "time");
    const std::optional<Time> first = own.reader.first_time();
    if (first) *time = first->count();
    return first ? 1 : 0;
  });
}

int splinecast_reader_wait(splinecast_reader* reader, int64_t timeout) {
  return with(reader, [&](splinecast_reader& own) {
    return static_cast<int>(own.reader.wait(timeout_of(timeout)));
  });
}

int splinecast_reader_alive(splinecast_reader* reader) {
  return with(reader, [](splinecast_reader& own) {
    const Alive alive = own.reader.alive();
    return (alive.producer ? SPLINECAST_PRODUCER_ALIVE : 0) |
           (alive.solver ? SPLINECAST_SOLVER_ALIVE : 0);
  });
}

int splinecast_reader_clock(splinecast_reader* reader) {
  return with(reader, [](splinecast_reader& own) { return static_cast<int>(own.reader.clock()); });
}

const char* splinecast_reader_name(splinecast_reader* reader, size_t dimension) {
  return text(reader, dimension, &splinecast_reader::names);
}

const char* splinecast_reader_unit(splinecast_reader* reader, size_t dimension) {
  return text(reader, dimension, &splinecast_reader::units);
}

const char* splinecast_reader_kind_text(splinecast_reader* reader, size_t dimension) {
  return text(reader, dimension, &splinecast_reader::kinds);
}

int splinecast_reader_kind(splinecast_reader* reader, size_t dimension, splinecast_dimension* out) {
  return with(reader, [&](splinecast_reader& own) {
    const Dimension found = dimension_of(own.reader, require_dimension(dimension, own));
    *require_pointer(out, "out") = {.kind = static_cast<int>(found.kind), .period = found.period};
    return 0;
  });
}

int splinecast_reader_is_memory_locked(splinecast_reader* reader) {
  return with(reader, [](splinecast_reader& own) -> int { return own.reader.is_memory_locked(); });
}

}  // extern "C"
