#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "apps/record/format/record.hpp"
#include "apps/record/watch/batch.hpp"
#include "apps/record/watch/board_watch.hpp"
#include "apps/record/watch/ring_watch.hpp"
#include "apps/record/watch/stream_times.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Watches one stream: attaches to its ring and its board, read-only, and writes what happens there
/// into a batch of records. Only loads from shared memory; takes no lock. One thread uses it.
class StreamWatch {
 public:
  /// `number`: of the stream in the recorder.
  StreamWatch(std::uint32_t number, std::string stream, const Trust& trust, Time wall_offset);

  [[nodiscard]] const std::string& stream() const noexcept { return stream_; }
  [[nodiscard]] bool is_attached() const noexcept { return ring_ != nullptr; }
  /// Whether both ring and board are attached.
  [[nodiscard]] bool is_complete() const noexcept { return ring_ && board_; }
  /// Whether the stream is finished, and all of it has been read.
  [[nodiscard]] bool is_finished() const noexcept {
    return board_ ? board_->is_finished() : was_finished_;
  }

  /// Attaches to what exists: the ring first, then the board of the same stream. System calls.
  /// Writes the options into the batch. Returns whether anything is attached that was not before.
  /// `was_there`: what exists is older than the recorder. Throws BadRegion if a region cannot be
  /// used.
  bool attach(Batch& batch, bool was_there);

  /// Whether look() has anything to do: some loads.
  [[nodiscard]] bool calls() const noexcept;
  /// Whether the last look read so much that the next one should not wait.
  [[nodiscard]] bool is_filled_fast() const noexcept { return ring_ && ring_->is_filled_fast(); }

  /// Reads what is new. Detaches from a stream that has been retired.
  void look(Batch& batch);

  /// Writes the last summary.
  void put_summary(Batch& batch) {
    if (board_) board_->put_summary(batch);
  }

  /// Looks whether a process has taken over a region: some loads.
  void look_at_owners(Batch& batch);

  /// What has been read until now may be in no file: verification has to begin again.
  void begin_again() noexcept {
    if (ring_) ring_->set_incomplete_before(ring_->next());
    if (board_) board_->begin_again();
  }

 private:
  void attach_ring(Batch& batch);
  void attach_board(Batch& batch, bool was_there);
  void put_options(Batch& batch) const;
  void detach(Batch& batch, const char* role);

  std::uint32_t number_;
  std::string stream_;
  Trust trust_;
  Time wall_offset_;
  struct Owners {
    std::pair<ipc::Word, ipc::Word> ring{};  ///< epoch and process id
    std::pair<ipc::Word, ipc::Word> board{};
  };
  Owners owners_;
  std::unique_ptr<StreamTimes> times_;  ///< of the ring
  std::unique_ptr<RingWatch> ring_;
  std::unique_ptr<BoardWatch> board_;
  bool was_finished_ = false;  ///< of the stream from which it has detached
};

}  // namespace splinecast::apps::record
