#include "apps/record/output/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <stdexcept>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/record/format/loss.hpp"
#include "apps/record/watch/events.hpp"

namespace splinecast::apps::record {
namespace {

/// A chunk ends after this time at the latest, so that a recorder that is killed loses less than a
/// second, together with the time that records wait in the queue.
constexpr Time kChunk = std::chrono::milliseconds(500);
constexpr Time kCheck = std::chrono::seconds(1);
constexpr Time kTryAgain = std::chrono::seconds(1);
constexpr Time kTidy = std::chrono::seconds(1);
/// Shortest life of a file before it is ended because of its size.
constexpr Time kShortest = std::chrono::seconds(1);
/// The account of a stream that has ended is kept longer than its records, by this time.
constexpr Time kKeepAccount = std::chrono::seconds(10);

}  // namespace

Files::Files(const OutputOptions& options)
    : options_(options),
      names_(options.path),
      memory_(options.last.value_or(Time::zero())),
      dumps_(options.last.value_or(Time::zero()), options.after) {
  if (keeps_memory()) {
    names_.require_folder();
    return;
  }
  wants_file_ = true;
  const bool is_numbered = options_.max_bytes || options_.max_files;
  const std::string path = is_numbered ? names_.next("", 1) : names_.path();
  file_ = std::make_unique<RecordingFile>(path, options_.file);
  memory_.need_from(0);
  own_.push_back({path, file_->id()});
  report_.files.push_back(path);
}

Files::~Files() = default;

void Files::take(Batch&& batch) {
  for (Record& record : batch.records) take(std::move(record));
  take_events(batch);
}

void Files::take_events(const Batch& batch) {
  for (const EventNote& event : batch.events) {
    if (!keeps_memory() || event.is_old || !options_.on.contains(event.kind)) continue;
    const std::string_view why = to_string(event.kind);
    if (dumps_.take_event(why, batch.now)) begin_dump(why, batch.now);
  }
  report_.further_events = dumps_.further_events();
}

void Files::take(Record record) {
  ++report_.records[record.kind];
  accounts_.add(record);
  if (record.kind == RecordKind::options && file_) {
    if (!file_->can_begin_stream()) rotate(record.seen);
    if (file_) end_chunk(record.seen);  // as the metadata of the stream would
  }
  if (file_) {
    write(record);
    if (!has_chunk_) {
      has_chunk_ = true;
      chunk_since_ = record.seen;
    }
  }
  const Time now = record.seen;
  const bool is_data = record.kind != RecordKind::summary;
  const std::uint32_t stream = record.stream;
  const bool is_end = is_end_of_stream(record);
  memory_.add(std::move(record), forget());
  if (is_data) data_until_ = memory_.added();
  if (is_end) end_stream(stream, now);
  if (file_ && file_->failed()) return fail(file_->why(), now);
  const bool is_chunk_due = memory_.bytes() > RecordMemory::kMostHeld / 2;
  if (file_ && (is_chunk_due || !file_->has_open_chunk())) end_chunk(now);
}

/// The next record of the same number belongs to another stream.
void Files::end_stream(std::uint32_t stream, Time now) {
  memory_.end(stream);
  accounts_.end(stream);
  if (!file_) return;
  write_account({stream, accounts_.present(stream)}, now, false);
  file_->end(stream);
}

/// Writes a record. One that cannot be written is lost, and no other one of any stream is.
void Files::write(const Record& record) {
  try {
    file_->write(record);
  } catch (const std::runtime_error& error) {
    say(fmt::format("{}: {}", file_->path(), error.what()));
    accounts_.forget(record, accounts_.present(record.stream), true);
  }
}

/// Counts records that are forgotten and in no file: as lost, if they should be in one.
RecordMemory::Forget Files::forget() {
  return [this](const Record& record, std::uint64_t sequence, ipc::Word stream_id) {
    if (sequence < whole_until_ || file_) return;
    accounts_.forget(record, stream_id, wants_file_);
    if (!wants_file_) return;
    Loss loss{.cause = LossCause::file};
    if (record.kind == RecordKind::loss) {
      loss = decode_loss(std::span(record.bytes).subspan(1));
    } else if (record.is_counted) {
      loss.count(record);
    }
    lost_[{record.stream, stream_id}].add(loss);
  };
}

void Files::note_whole_chunks() noexcept {
  if (!file_ || file_->failed()) return;
  whole_until_ = memory_.added();
  memory_.need_from(whole_until_);
  has_chunk_ = false;
}

/// Writes the account of a stream, if the file has the stream.
void Files::write_account(const Accounts::Key& stream, Time now, bool is_needed) {
  if (!file_->has(stream.first, stream.second)) return;
  const Account* const account = accounts_.changed(stream, is_needed);
  if (account == nullptr) return;
  write({.stream = stream.first,
         .kind = RecordKind::account,
         .own_time = now,
         .seen = now,
         .bytes = encode(*account)});
}

void Files::write_accounts(Time now) {
  if (!file_ || file_->failed()) return;
  for (const auto& stream : accounts_.all_changed()) {
    write_account(stream, now, false);
    if (!file_->has_open_chunk()) note_whole_chunks();
  }
}

void Files::say_losses() {
  const Account total = accounts_.total();
  const LossCounts all = total.all_lost();
  if (all.all() == said_.all()) return;
  said_ = all;
  say(lost_in_words(total.lost) + " so far");
}

OutputReport Files::report() const {
  OutputReport report = report_;
  report.account = accounts_.total();
  report.losses = accounts_.losses();
  return report;
}

TriggerResult Files::trigger(Time now) {
  const std::size_t files = report_.files.size();
  if (keeps_memory()) {
    if (file_) (void)close_file(now);
    dumps_.take_trigger(now);
    begin_dump("trigger", now);
  } else {
    rotate(now);
  }
  // A dump without further time may be complete already.
  if (report_.files.size() > files) return {.is_done = true, .text = report_.files[files]};
  return {.text = fmt::format("{}; it is written as soon as that is possible", why_)};
}

/// Begins a file with what is in memory, and `why` in its name.
void Files::begin_dump(std::string_view why, Time now) {
  wants_file_ = true;
  memory_.need_from(whole_until_);
  wanted_ = why;
  is_part_ = false;
  next_try_ = now;
  tick(now);
}

void Files::end_dump(Time now) {
  if (!close_file(now)) return;
  wants_file_ = false;
  memory_.need_from(RecordMemory::kNone);
  if (const auto next = dumps_.close(now)) begin_dump(*next, now);
}

/// Begins a file with what is in memory. Returns whether its first chunk has been written.
bool Files::open(Time now) {
  const std::size_t least = keeps_memory() ? 1 : 2;  // the first of other files has no number, or 1
  std::string path;
  try {
    path = names_.next(wanted_, least);
    file_ = std::make_unique<RecordingFile>(path, options_.file);
  } catch (const Failure& error) {
    if (!path.empty()) names_.forget_last(wanted_);
    fail(error.what(), now);
    return false;
  }
  write_memory(now);
  if (file_->failed()) {
    const std::string why = fmt::format("{}: {}", path, file_->why());
    file_.reset();
    unlink(path.c_str());  // the next file has all of it
    names_.forget_last(wanted_);
    fail(why, now);
    return false;
  }
  note_whole_chunks();
  memory_.hold(false);
  opened_ = now;
  repeated_ = file_->bytes();
  lost_.clear();
  own_.push_back({path, file_->id()});
  report_.files.push_back(path);
  remove_oldest();
  return true;
}

/// Begins the file with what is in memory. A part of a dump does not repeat all of it: else each
/// part could be as large as `max_bytes` at once.
void Files::write_memory(Time now) {
  const bool is_short = is_part_ && !is_failing_;
  memory_.give(is_short ? RecordMemory::Extent::newest_start : RecordMemory::Extent::all,
               [&](const Record& record) {
                 write(record);
                 if (record.kind == RecordKind::options) write_losses(record, now);
               });
  file_->end_chunk();
}

/// Writes what was lost of a stream before this file, and the account until now: before the
/// stream's other records, with which a new part begins.
void Files::write_losses(const Record& options, Time now) {
  const auto found = lost_.find({options.stream, options.number});
  Batch batch{.now = now};
  if (found != lost_.end()) {
    for (const Loss& loss : found->second.losses()) add_loss(batch, options.stream, loss, now);
  }
  for (const Record& record : batch.records) write(record);
  write_account({options.stream, options.number}, now, true);
}

void Files::fail(const std::string& why, Time now) {
  why_ = why;
  if (!is_failing_) {
    const std::string what = file_ ? fmt::format("{}: {}", file_->path(), why) : why;
    say(fmt::format("{}; recording continues as soon as a file can be written", what));
    ++report_.failures;
  }
  is_failing_ = true;
  memory_.hold(true);
  if (file_) report_.bytes += file_->written();
  file_.reset();
  has_chunk_ = false;
  next_try_ = now + kTryAgain;
}

/// Completes the file. Returns false if that failed: then another one should follow, with what
/// this one lacks.
bool Files::close_file(Time now) {
  write_accounts(now);
  end_chunk(now);  // what is in a whole chunk is recorded, also if the summary cannot be written
  if (!file_) return false;
  file_->finish();
  if (!file_->why().empty()) {
    fail(file_->why(), now);
    return false;
  }
  report_.bytes += file_->written();
  note_whole_chunks();
  file_.reset();
  has_chunk_ = false;
  return true;
}

void Files::rotate(Time now) {
  if (!file_) return;
  (void)close_file(now);
  is_part_ = true;
  next_try_ = now;
  tick(now);
}

void Files::remove_oldest() {
  while (options_.max_files && own_.size() > *options_.max_files) {
    const OwnFile& oldest = own_.front();
    if (file_id(oldest.path) == oldest.id) unlink(oldest.path.c_str());  // else it was replaced
    own_.pop_front();
  }
}

void Files::tick(Time now) {
  if (now >= next_tidy_) {
    next_tidy_ = now + kTidy;
    memory_.tidy(now, forget());
    write_accounts(now);
    accounts_.tidy(now - kKeepAccount, [this](const Accounts::Key& stream) {
      return memory_.has(stream.first, stream.second);
    });
    say_losses();
  }
  try_again(now);
  end_chunk_if_due(now);
  check_file(now);
  if (!file_) return;
  if (dumps_.is_due(now)) {
    end_dump(now);
  } else if (is_full() && now - opened_ >= kShortest) {
    rotate(now);
  }
}

/// Whether the file has its size, and not only by what it repeats of an earlier one.
bool Files::is_full() const noexcept {
  return options_.max_bytes && file_->bytes() >= *options_.max_bytes &&
         file_->bytes() - repeated_ >= *options_.max_bytes / 2;
}

/// Opens a file if one should be open.
void Files::try_again(Time now) {
  if (!wants_file_ || file_ || now < next_try_) return;
  if (open(now) && std::exchange(is_failing_, false)) {
    say(fmt::format("recording continues in {}", file_->path()));
  }
}

void Files::end_chunk_if_due(Time now) {
  if (file_ && has_chunk_ && now - chunk_since_ >= kChunk) end_chunk(now);
}

void Files::end_chunk(Time now) {
  file_->end_chunk();
  if (file_->failed()) return fail(file_->why(), now);
  note_whole_chunks();
}

/// Checks whether the file is still in its place.
void Files::check_file(Time now) {
  if (!file_ || now < next_check_) return;
  next_check_ = now + kCheck;
  if (file_->is_in_place()) return;
  write_accounts(now);
  file_->end_chunk();
  note_whole_chunks();
  file_->finish();
  own_.pop_back();  // another file may have its name
  fail("it was moved or removed", now);
}

void Files::finish(Time now) {
  if (keeps_memory() && !wants_file_ && data_until_ > whole_until_) begin_dump("end", now);
  const bool is_complete = file_ && close_file(now);
  if (wants_file_ && !is_complete && !file_) {
    next_try_ = now;
    try_again(now);
    if (file_) (void)close_file(now);
  }
  if (wants_file_) memory_.clear(forget());  // counts what is in no file
}

}  // namespace splinecast::apps::record
