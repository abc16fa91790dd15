#pragma once

#include <optional>
#include <string>

#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/settled_raise.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::ipc {

class RegionWatch;
class SolverWatch;

/// Access to the internals of the public roles, for other parts of this project: its program, its
/// sweep over many streams, its tests. Same thread rules as the role itself.
struct Internals {
  /// The sampler that `Reader::sample` uses: for code that also samples boards without a Reader.
  [[nodiscard]] static Sampler& sampler(Reader& reader) noexcept;
  /// The header of the board.
  [[nodiscard]] static const RegionHeader& header(const Reader& reader) noexcept;
  /// Copies the summary of the newest revision. Returns false if there is none, or if the writer
  /// overtook every try.
  [[nodiscard]] static bool summary(const Reader& reader, Summary& out) noexcept;

  /// A producer with this host's clock, which outlives it.
  [[nodiscard]] static Producer producer(std::string stream, ProducerOptions options,
                                         const Clock& clock);

  /// The solver uses this watch, which outlives it and whose owner calls its poll() before each
  /// step, instead of one of its own.
  static void share(Solver& solver, const RegionWatch& watch) noexcept;

  /// The summary last committed. This and the next three functions require an attached solver.
  [[nodiscard]] static const Summary& summary(const Solver& solver) noexcept;
  /// The header of the board, which holds the solver's options.
  [[nodiscard]] static const RegionHeader& board(const Solver& solver) noexcept;
  /// The largest excess of a waypoint that was not refused.
  [[nodiscard]] static std::optional<LimitExcess> worst_excess(const Solver& solver) noexcept;
  /// What to poll before the next step.
  [[nodiscard]] static SolverWatch watch(const Solver& solver) noexcept;
  /// Tries to acquire the lock on the board's region unless it is held: it shows other users that
  /// the solver is alive, and another user's lock may have prevented it so far. wait(), and step()
  /// when it wakes readers, do the same. Returns whether it is held. One system call if it was not.
  static bool hold_region(Solver& solver) noexcept;

  /// What `prefetch` fetches: the solver's object, the parts that it points to, or the stream's
  /// memory. Each stage loads the memory that the previous one has prefetched.
  enum class Stage { self, parts, stream };
  static void prefetch(const Solver& solver, Stage stage) noexcept;
};

}  // namespace splinecast::ipc
