#pragma once

#include <array>
#include <atomic>
#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>

#include "ipc/ring/item.hpp"

namespace splinecast::campaign {

/// Steps of a writer that store to shared memory. A kill can be armed for each of them.
enum class Step : std::uint64_t {
  none,
  make_ring,            ///< the producer creates, takes over or recreates its region
  append,               ///< the producer appends a waypoint
  replace,              ///< the producer replaces the future
  finish,               ///< the producer finishes the stream
  make_board,           ///< the solver creates or takes over its first region
  make_board_again,     ///< the solver replaces its region by that of the stream's next life
  publish,              ///< the solver consumes a waypoint and publishes
  publish_replacement,  ///< the solver consumes a replacement and publishes
  publish_finish,       ///< the solver consumes the end and publishes
  sleep,                ///< the solver stores that it sleeps, and that it is awake
  remove,               ///< `rm` removes the stream
};

inline constexpr std::size_t kMostReaders = 16;

/// Counters of a reader, summed over its processes: a killed reader is started again.
struct ReaderFacts {
  std::atomic<std::uint64_t> turns;         ///< grows unless the reader hangs
  std::atomic<std::uint64_t> life_samples;  ///< samples with values of the current process
  std::atomic<std::uint64_t> samples;       ///< samples with values
  std::atomic<std::uint64_t> busy;          ///< samples that the writer overtook
  std::atomic<std::uint64_t> segments;      ///< segments copied and checked
  std::atomic<std::uint64_t> items;         ///< ring items observed and checked
  std::atomic<std::uint64_t> torn;          ///< samples, segments or items that mix two versions
  std::atomic<std::uint64_t> stepped;       ///< joins where the curve steps
  std::atomic<std::uint64_t> ends;          ///< newest segments of unfinished curves, checked
  std::atomic<std::uint64_t> restless;      ///< those of `ends` that do not end at rest
  std::atomic<std::uint64_t> changed;       ///< settled samples that changed later
  std::atomic<std::uint64_t> wrong;         ///< settled segments that differ from their reference
};

/// Memory that the processes of one stream share; it outlives each of them.
struct Journal {
  std::atomic<Step> armed;               ///< step in which to die; `none` after it has survived
  std::atomic<std::uint64_t> store;      ///< number of the store to die before, from 1
  std::atomic<std::uint64_t> accepted;   ///< ring items whose append was accepted
  std::atomic<ipc::ItemKind> last_sent;  ///< kind of the item that the producer appended last
  std::array<ReaderFacts, kMostReaders> readers;
  ReaderFacts observer;  ///< counters of the attacking process, which also reads
};
static_assert(std::atomic<Step>::is_always_lock_free);
static_assert(std::atomic<ipc::ItemKind>::is_always_lock_free);

/// A zero-initialised journal, shared with all children forked after its construction.
class SharedJournal {
 public:
  SharedJournal();
  [[nodiscard]] Journal& operator*() const noexcept { return *journal_; }
  [[nodiscard]] Journal* operator->() const noexcept { return journal_; }

 private:
  boost::interprocess::mapped_region memory_;
  Journal* journal_;
};

/// Scope of a step of a writer. If the step is armed and the build has hooks, the process dies
/// before store number `Journal::store` of this scope.
class WithinStep {
 public:
  WithinStep(Journal& journal, Step step) noexcept;
  WithinStep(const WithinStep&) = delete;
  WithinStep& operator=(const WithinStep&) = delete;
  ~WithinStep();

  /// Reports that the step has done all its stores, fewer than `Journal::store`.
  void survived() noexcept;

 private:
  Journal* journal_;
  bool is_armed_;
};

/// Whether this build has hooks.
[[nodiscard]] bool has_hooks() noexcept;

/// Kills this process before its store of that number, from 1 on; 0 cancels. Nothing without hooks.
void kill_before_store(std::uint64_t number) noexcept;

}  // namespace splinecast::campaign
