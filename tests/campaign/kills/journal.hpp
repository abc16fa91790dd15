#pragma once

#include <array>
#include <atomic>
#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>

#include "ipc/ring/item.hpp"

namespace splinecast::campaign {

/// What a writer does to shared memory, from a marker on: where a kill can be asked for.
enum class Step : std::uint64_t {
  none,
  make_ring,            ///< the producer makes its region, continues one or makes a stream anew
  append,               ///< it appends a waypoint
  replace,              ///< it replaces the future
  finish,               ///< it ends the stream
  make_board,           ///< the solver makes its region, or takes one over
  publish,              ///< it takes a waypoint and publishes
  publish_replacement,  ///< it takes a replacement and publishes
  publish_finish,       ///< it takes the end and publishes
  sleep,                ///< it says that it sleeps, and that it is awake
  remove,               ///< `rm` removes the stream
};

inline constexpr std::size_t kMostReaders = 16;

/// What a reader has counted, over all its lives.
struct ReaderFacts {
  std::atomic<std::uint64_t> turns;         ///< grows as long as it does not hang
  std::atomic<std::uint64_t> life_samples;  ///< with values, in this life of its process
  std::atomic<std::uint64_t> samples;       ///< with values
  std::atomic<std::uint64_t> busy;          ///< samples that the writer overtook
  std::atomic<std::uint64_t> segments;      ///< copied and checked
  std::atomic<std::uint64_t> items;         ///< of the ring, observed and checked
  std::atomic<std::uint64_t> torn;          ///< samples, segments or items mixed of two versions
  std::atomic<std::uint64_t> stepped;       ///< joins where the curve steps
  std::atomic<std::uint64_t> ends;          ///< newest segments seen, behind which nothing stands
  std::atomic<std::uint64_t> restless;      ///< those at whose end the curve moves
  std::atomic<std::uint64_t> changed;       ///< settled samples that read otherwise later
  std::atomic<std::uint64_t> wrong;         ///< settled segments that are not those they must be
};

/// What the processes of one stream tell one another, in memory that outlives each of them.
struct Journal {
  std::atomic<Step> armed;               ///< the step in which to die; none once it was survived
  std::atomic<std::uint64_t> store;      ///< before which of its stores, from 1
  std::atomic<std::uint64_t> accepted;   ///< ring items whose append was accepted
  std::atomic<ipc::ItemKind> last_sent;  ///< what the producer appended last
  std::array<ReaderFacts, kMostReaders> readers;
  ReaderFacts observer;  ///< the process that attacks reads too
};
static_assert(std::atomic<Step>::is_always_lock_free);
static_assert(std::atomic<ipc::ItemKind>::is_always_lock_free);

/// A journal, zero at first, that children which are forked from now on share.
class SharedJournal {
 public:
  SharedJournal();
  [[nodiscard]] Journal& operator*() const noexcept { return *journal_; }
  [[nodiscard]] Journal* operator->() const noexcept { return journal_; }

 private:
  boost::interprocess::mapped_region memory_;
  Journal* journal_;
};

/// While it lives, a writer is within a step: if that step is armed, and the build has hooks, the
/// process dies before the store that the journal says.
class WithinStep {
 public:
  WithinStep(Journal& journal, Step step) noexcept;
  WithinStep(const WithinStep&) = delete;
  WithinStep& operator=(const WithinStep&) = delete;
  ~WithinStep();

  /// The step has done all its stores: there was none to die before.
  void survived() noexcept;

 private:
  Journal* journal_;
  bool is_armed_;
};

/// Whether this build can die within a step.
[[nodiscard]] bool has_hooks() noexcept;

}  // namespace splinecast::campaign
