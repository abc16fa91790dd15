#include "apps/tables/kept_rows.hpp"

#include <algorithm>
#include <cstring>

#include "apps/process/exit_codes.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {

bool KeptRows::next(Row& row) {
  if (next_ < kept_) {
    const auto error = errors_.find(next_);
    ++next_;
    if (error == errors_.end()) {
      take(row);
      return true;
    }
    row.number = error->second.first;
    throw InputError(error->second.second);
  }
  if (read_ < next_) {  // after rewind()
    rows_->skip(next_ - read_);
    read_ = next_;
  }
  return read_on(row);
}

/// Reads the next row from the file, and keeps it if there is room.
bool KeptRows::read_on(Row& row) {
  try {
    if (!rows_->next(row)) {
      is_full_ = true;
      return false;
    }
  } catch (const InputError& error) {
    if (row.number == 0) throw;
    ++read_;
    ++next_;
    is_full_ = is_full_ || errors_.size() == kMostErrors;
    if (!is_full_) errors_.emplace(kept_++, std::pair(row.number, error.what()));
    throw;
  }
  ++read_;
  ++next_;
  if (!is_full_) keep(row);
  return true;
}

void KeptRows::rewind() {
  next_ = block_ = word_ = 0;
  form_ = {};
  if (read_ == kept_) return;
  rows_->rewind();
  read_ = 0;
}

std::vector<double>& KeptRows::block_with_room(std::size_t words) {
  if (blocks_.empty() || blocks_.back().capacity() - blocks_.back().size() < words) {
    blocks_.emplace_back().reserve(std::max(kBlockWords, words));
  }
  return blocks_.back();
}

void KeptRows::put(std::vector<double>& block, std::uint64_t word) {
  block.emplace_back();
  std::memcpy(&block.back(), &word, sizeof(word));
}

std::uint64_t KeptRows::take_word() {
  std::uint64_t word = 0;
  std::memcpy(&word, &blocks_[block_][word_++], sizeof(word));
  return word;
}

void KeptRows::keep(const Row& row) {
  const Form form{row.number, !row.velocity.empty(), !row.acceleration.empty()};
  const bool is_usual = form == form_.next();
  const std::size_t words =
      (is_usual ? 1 : 2) + row.position.size() + row.velocity.size() + row.acceleration.size();
  std::vector<double>& block = block_with_room(words);
  is_full_ =
      blocks_.size() * kBlockWords * sizeof(double) > kMostBytes || !is_time_in_range(row.time);
  if (is_full_) return;
  put(block, static_cast<std::uint64_t>(row.time.count()) << 1U | (is_usual ? 0U : 1U));
  if (!is_usual) {
    put(block, std::uint64_t{form.number} << 2U | (form.has_velocity ? 1U : 0U) |
                   (form.has_acceleration ? 2U : 0U));
  }
  for (const auto values : {row.position, row.velocity, row.acceleration}) {
    block.insert(block.end(), values.begin(), values.end());
  }
  form_ = form;
  ++kept_;
}

/// Takes the next row from memory.
void KeptRows::take(Row& row) {
  if (word_ == blocks_[block_].size()) {
    ++block_;
    word_ = 0;
  }
  const std::uint64_t time = take_word();
  form_ = form_.next();
  if ((time & 1U) != 0) {
    const std::uint64_t form = take_word();
    form_ = {form >> 2U, (form & 1U) != 0, (form & 2U) != 0};
  }
  const auto part = [&](bool is_there) {
    const auto values = std::span<const double>(blocks_[block_])
                            .subspan(word_, is_there ? columns().dimensions() : 0);
    word_ += values.size();
    return values;
  };
  row.number = form_.number;
  row.time = Time(static_cast<std::int64_t>(time) >> 1U);
  row.position = part(true);
  row.velocity = part(form_.has_velocity);
  row.acceleration = part(form_.has_acceleration);
}

}  // namespace splinecast::apps
