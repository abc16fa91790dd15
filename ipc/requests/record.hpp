#pragma once

#include <cstddef>
#include <span>

#include "ipc/memory/word.hpp"

/// The latest request of a commander or a stopper, in the control block of its region: one record
/// under a sequence counter.
///
/// One writer, any number of readers that store nothing. The sequence is even while the record is
/// whole.
///
/// Q1 The writer stores the next odd sequence (relaxed), each word of the record (release), and the
///    next even sequence (release). An earlier writer may have died in between: a sequence that is
///    found odd stays odd while the words are written.
/// Q2 A reader loads the sequence (acquire), each word of the record (acquire), and the sequence
///    again (relaxed). The copy is whole iff both are the same even number.
///
/// Why: the first load acquires the last store of that sequence's writer, so each word is at least
/// as new as that. A word of a later record is stored with release after its odd sequence; a reader
/// that loads that word with acquire finds this sequence or a later one in its second load. A
/// sequence repeats only after 2⁶³ requests.
///
/// Not enough (found by the model, tests/model/commander_record.pml): one sequence that is stored
/// before the words only, or after them only; a reader that compares the sequences but takes an odd
/// one.
namespace splinecast::ipc {

/// Where the sequence and the words of the record are in a control block.
inline constexpr std::size_t kRecordSequence = 0;
inline constexpr std::size_t kRecordWords = 2;

/// Writes a record: Q1. `control` is the control block of the region. Wait-free.
void write_record(std::span<Word> control, std::span<const Word> words) noexcept;

/// How a record was copied.
struct RecordCopy {
  Word sequence = 0;
  bool is_whole = false;  ///< no writer was seen in between

  /// Whether no request has been made yet.
  [[nodiscard]] bool is_unwritten() const noexcept { return is_whole && sequence == 0; }
};

/// Copies a record in a bounded number of tries: Q2.
[[nodiscard]] RecordCopy copy_record(std::span<const Word> control, std::span<Word> out) noexcept;

}  // namespace splinecast::ipc
