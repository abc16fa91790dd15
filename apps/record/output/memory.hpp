#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>

#include "apps/record/format/messages.hpp"
#include "apps/record/format/record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Keeps the newest records of each stream, from which a new file begins: those of the last
/// `window`, and before them what verification needs. One thread uses it.
class RecordMemory {
 public:
  /// Keeps the records of this time. 0: only from the last place at which verification can begin.
  explicit RecordMemory(Time window) : window_(window) {}

  /// Called for each record that is no longer kept. `sequence`: how many were added before it.
  /// `stream_id`: of its stream.
  using Forget =
      std::function<void(const Record& record, std::uint64_t sequence, ipc::Word stream_id)>;

  /// Adds a record, and forgets those that are no longer needed.
  void add(Record record, const Forget& forget);

  /// Records from this sequence number on are not in a file yet, and should be: forgets none of
  /// them until all records take kMostHeld. kNone: no file is wanted.
  void need_from(std::uint64_t sequence) noexcept { needed_from_ = sequence; }
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  /// Forgets nothing until the records take kMostHeld: no file can be written.
  void hold(bool holds) noexcept { holds_ = holds; }
  static constexpr std::size_t kMostHeld = std::size_t{64} << 20U;
  /// Meanwhile, the options of this number of streams are kept, for what is said of their losses.
  static constexpr std::size_t kMostEmpty = 4096;

  /// Which records give() gives: all, or of each stream those from the newest place on at which
  /// verification can begin, and without such a place those that are not in a file yet.
  enum class Extent : std::uint8_t { all, newest_start };
  /// Gives kept records: for each stream its options, items, and the others.
  void give(Extent extent, const std::function<void(const Record& record)>& take) const;

  /// The stream has ended: its records are only kept for the window, unless it continues.
  void end(std::uint32_t stream) noexcept;

  /// Forgets old records of streams to which nothing has been added.
  void tidy(Time now, const Forget& forget);

  /// Forgets all records.
  void clear(const Forget& forget);

  /// Whether it has anything of a stream.
  [[nodiscard]] bool has(std::uint32_t stream, ipc::Word id) const;

  /// Number of records added so far.
  [[nodiscard]] std::uint64_t added() const noexcept { return added_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  struct Kept {
    std::uint64_t sequence;
    Record record;
  };
  /// A place at which verification can begin.
  struct Start {
    std::uint64_t sequence;
    ipc::Word first_item;
    Time seen;
  };
  struct Stream {
    std::optional<Record> options{};
    Time newest{};  ///< when its newest record was read
    bool has_ended = false;
    std::deque<Kept> items{};  ///< items and refusals
    std::deque<Kept> others{};
    std::deque<Start> starts{};
    std::size_t bytes = 0;
  };

  Stream& stream_of(const Record& record, const Forget& forget);
  void drop_old(std::uint32_t stream, Time oldest, const Forget& forget);
  void empty(Stream& stream, const Forget& forget);
  void trim(Stream& stream, Time now, const Forget& forget);
  void pop(Stream& stream, std::deque<Kept>& from, const Forget& forget);
  [[nodiscard]] bool may_forget(const Kept& kept) const noexcept;
  [[nodiscard]] bool may_forget_before(std::uint64_t sequence) const noexcept;
  [[nodiscard]] bool may_erase(const Stream& stream) const noexcept;

  Time window_;
  /// By number; several if a stream was recreated.
  std::multimap<std::uint32_t, Stream> streams_;
  bool holds_ = false;
  std::uint64_t needed_from_ = kNone;
  std::uint64_t added_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace splinecast::apps::record
