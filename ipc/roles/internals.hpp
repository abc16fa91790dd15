#pragma once

#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/settled_raise.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::ipc {

class SolverWatch;

/// What lies behind the public roles, for the parts of this project that look deeper than a user
/// can: its program, its sweep over many streams, its tests. Threads as the role itself.
struct Internals {
  /// What `Reader::sample` asks: for code that works on streams in plain memory as well.
  [[nodiscard]] static Sampler& sampler(Reader& reader) noexcept;
  /// What the header of the board says.
  [[nodiscard]] static const RegionHeader& header(const Reader& reader) noexcept;
  /// Copies the head of the newest revision. Returns false if there is none, or if the writer
  /// overtook every try.
  [[nodiscard]] static bool head(const Reader& reader, Head& out) noexcept;

  /// The head last committed; an attached solver only, as all that follow.
  [[nodiscard]] static const Head& head(const Solver& solver) noexcept;
  /// The header of the board, which says how the stream is solved.
  [[nodiscard]] static const RegionHeader& board(const Solver& solver) noexcept;
  /// What to look at before the next step.
  [[nodiscard]] static SolverWatch watch(const Solver& solver) noexcept;
  /// Takes the lock on the board by which other users see that its solver lives, if a lock of
  /// theirs kept this solver from it before. wait(), and step() where it wakes readers, do so too.
  /// Returns whether it is held. A system call if it was not.
  static bool hold_region(Solver& solver) noexcept;

  /// What `prefetch` asks for: the solver's object, the parts that it points to, or the stream's
  /// memory. Each stage loads what the one before has asked for.
  enum class Stage { self, parts, stream };
  static void prefetch(const Solver& solver, Stage stage) noexcept;
};

}  // namespace splinecast::ipc
