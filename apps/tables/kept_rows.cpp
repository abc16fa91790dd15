#include "apps/tables/kept_rows.hpp"

#include <algorithm>
#include <cstring>

#include "apps/process/exit_codes.hpp"

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

void KeptRows::keep(const Row& row) {
  const std::size_t words =
      kHeaderWords + row.position.size() + row.velocity.size() + row.acceleration.size();
  std::vector<double>& block = block_with_room(words);
  is_full_ = blocks_.size() * kBlockWords * sizeof(double) > kMostBytes;
  if (is_full_) return;
  const Header header{.time = row.time.count(),
                      .number = row.number & (~std::uint64_t{0} >> 2U),
                      .has_velocity = !row.velocity.empty(),
                      .has_acceleration = !row.acceleration.empty()};
  const std::size_t at = block.size();
  block.resize(at + kHeaderWords);
  std::memcpy(block.data() + at, &header, sizeof(header));
  for (const auto values : {row.position, row.velocity, row.acceleration}) {
    block.insert(block.end(), values.begin(), values.end());
  }
  ++kept_;
}

/// Takes the next row from memory.
void KeptRows::take(Row& row) {
  if (word_ == blocks_[block_].size()) {
    ++block_;
    word_ = 0;
  }
  const auto words = std::span<const double>(blocks_[block_]);
  Header header{};
  std::memcpy(&header, words.data() + word_, sizeof(header));
  word_ += kHeaderWords;
  const auto part = [&](bool is_there) {
    const auto values = words.subspan(word_, is_there ? columns().dimensions() : 0);
    word_ += values.size();
    return values;
  };
  row.number = header.number;
  row.time = Time(header.time);
  row.position = part(true);
  row.velocity = part(header.has_velocity != 0);
  row.acceleration = part(header.has_acceleration != 0);
}

}  // namespace splinecast::apps
