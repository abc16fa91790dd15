#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "apps/record/output/files.hpp"
#include "apps/record/watch/batch.hpp"
#include "apps/record/watch/clocks.hpp"

namespace splinecast::apps::record {

/// The thread that encodes, compresses and writes what a bounded queue gives it: the thread that
/// observes the streams never waits for it.
class WriterThread {
 public:
  /// Maximum size of the records in the queue.
  static constexpr std::size_t kMostQueued = std::size_t{64} << 20U;

  /// Opens the first file. Throws Failure.
  WriterThread(const OutputOptions& options, const WallClock& clock);
  WriterThread(const WriterThread&) = delete;
  WriterThread& operator=(const WriterThread&) = delete;
  ~WriterThread();

  /// Whether the queue has room for a batch: the caller counts what it drops. Rethrows an exception
  /// of the thread.
  [[nodiscard]] bool has_room(const Batch& batch);

  /// Puts a batch into the queue and empties it.
  void put(Batch& batch);

  /// Puts a trigger into the queue: a request to dump, or to begin a new file.
  void trigger();
  /// What came of it, once.
  [[nodiscard]] std::optional<TriggerResult> take_trigger_result();

  /// Writes all of the queue and a last batch, ends the last file and the thread. Rethrows an
  /// exception of it.
  OutputReport finish(Batch last);

 private:
  struct Trigger {};
  using Job = std::variant<Batch, Trigger>;

  void run() noexcept;
  void work();
  std::size_t do_all(std::deque<Job> jobs);
  void push(Job job, std::size_t bytes);
  void rethrow();

  Files files_;
  const WallClock& clock_;
  std::mutex mutex_;
  std::condition_variable wakes_;
  std::deque<Job> jobs_;
  std::size_t queued_ = 0;  ///< bytes of the batches that have not been written
  std::optional<TriggerResult> triggered_{};
  bool is_ending_ = false;
  std::exception_ptr failure_{};
  std::thread thread_;
};

}  // namespace splinecast::apps::record
