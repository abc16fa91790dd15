#include "apps/record/output/writer_thread.hpp"

#include <pthread.h>

#include <chrono>
#include <csignal>
#include <utility>

namespace splinecast::apps::record {
namespace {

constexpr auto kTick = std::chrono::milliseconds(100);

/// Signals are for the thread that observes: they must not interrupt a write.
void block_signals() noexcept {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
}

}  // namespace

WriterThread::WriterThread(const OutputOptions& options, const WallClock& clock)
    : files_(options), clock_(clock), thread_([this] { run(); }) {}

WriterThread::~WriterThread() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_one();
  thread_.join();
}

bool WriterThread::has_room(const Batch& batch) {
  const std::lock_guard lock(mutex_);
  rethrow();
  return queued_ == 0 || queued_ + batch.bytes <= kMostQueued;
}

void WriterThread::put(Batch& batch) {
  const std::size_t bytes = batch.bytes;
  Batch next{.now = batch.now};
  next.records.reserve(batch.records.size());
  push(std::exchange(batch, std::move(next)), bytes);
}

void WriterThread::trigger() { push(Trigger{}, 0); }

std::optional<TriggerResult> WriterThread::take_trigger_result() {
  const std::lock_guard lock(mutex_);
  return std::exchange(triggered_, std::nullopt);
}

void WriterThread::push(Job job, std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    queued_ += bytes;
  }
  wakes_.notify_one();
}

OutputReport WriterThread::finish(Batch last) {
  put(last);
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_one();
  thread_.join();
  rethrow();
  return files_.report();
}

void WriterThread::rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

void WriterThread::run() noexcept {
  block_signals();
  try {
    work();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void WriterThread::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wakes_.wait_for(lock, kTick, [this] { return !jobs_.empty() || is_ending_; });
    if (jobs_.empty() && is_ending_) break;
    std::deque<Job> jobs = std::exchange(jobs_, {});
    lock.unlock();
    const std::size_t done = do_all(std::move(jobs));
    lock.lock();
    queued_ -= done;
    if (!jobs_.empty()) continue;
    // Time passes for the files with the records, and with the clock if there are none: a dump must
    // not end before the records of its time, which a slow disk delays.
    lock.unlock();
    files_.tick(clock_.now());
    lock.lock();
  }
  lock.unlock();
  files_.finish(clock_.now());
}

/// Returns the size of the batches.
std::size_t WriterThread::do_all(std::deque<Job> jobs) {
  std::size_t done = 0;
  for (Job& job : jobs) {
    if (auto* const batch = std::get_if<Batch>(&job)) {
      const Time now = batch->now;
      done += batch->bytes;
      files_.take(std::move(*batch));
      files_.tick(now);
    } else {
      TriggerResult result = files_.trigger(clock_.now());
      const std::lock_guard lock(mutex_);
      triggered_ = std::move(result);
    }
  }
  return done;
}

}  // namespace splinecast::apps::record
