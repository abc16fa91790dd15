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

bool WriterThread::put(Batch& batch) {
  const std::size_t bytes = batch.bytes;
  {
    const std::lock_guard lock(mutex_);
    rethrow();
    if (queued_ > 0 && queued_ + bytes > kMostQueued) return false;
  }
  push(std::exchange(batch, Batch{.now = batch.now}), bytes);
  return true;
}

void WriterThread::dump(const std::string& why) { push(DumpRequest{why}, 0); }

void WriterThread::push(Job job, std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    queued_ += bytes;
  }
  wakes_.notify_one();
}

OutputReport WriterThread::finish() {
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
    std::size_t done = 0;
    for (Job& job : jobs) {
      if (auto* const batch = std::get_if<Batch>(&job)) {
        const std::size_t bytes = batch->bytes;
        files_.take(std::move(*batch));
        done += bytes;
      } else {
        files_.dump(std::get<DumpRequest>(job).why, clock_.now());
      }
      files_.tick(clock_.now());
    }
    files_.tick(clock_.now());
    lock.lock();
    queued_ -= done;
  }
  lock.unlock();
  files_.finish(clock_.now());
}

}  // namespace splinecast::apps::record
