#pragma once

#include <cstdint>

#include "apps/record/format/bytes.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The kinds of messages of the exact channel; `event` is only in a recorder's memory.
enum class RecordKind : std::uint8_t {
  options = 1,
  item = 2,
  refusal = 3,
  segment = 4,
  restart = 5,
  summary = 6,
  loss = 7,
  account = 8,
  event = 100,  ///< JSON text of the channel of events
};

/// What a recorder has read from a stream, on its way to a file.
struct Record {
  std::uint32_t stream = 0;  ///< number of the stream in the recorder
  RecordKind kind{};
  ipc::Word number = 0;  ///< of an item, of a refused item, of a segment; of a restart the first
                         ///< item that it needs; of options the id of the stream; of an event
                         ///< its kind
  ipc::Word next = 0;    ///< of an item and a segment the number that follows; of options 1 if they
                         ///< are those of a new solver, too
  Time own_time{};       ///< stream time on the host's wall clock: see docs/file-formats.md
  Time own_end{};        ///< of a segment: the same of its right end
  Time seen{};           ///< wall clock when it was read
  bool is_old = false;   ///< it was there before the recorder came
  bool is_counted = false;  ///< whether the account has it as recorded: not if it is read again
  Bytes bytes{};            ///< the message, with its kind in the first byte; of an event its text
};

}  // namespace splinecast::apps::record
