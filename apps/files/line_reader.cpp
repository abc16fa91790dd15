#include "apps/files/line_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr std::size_t kBlock = std::size_t{256} << 10U;

}  // namespace

bool LineReader::next(Line& line) {
  const char* end = nullptr;
  for (std::size_t searched = begin_;;) {
    const char* const from = buffer_.data() + searched;
    end = searched < end_ ? static_cast<const char*>(std::memchr(from, '\n', end_ - searched))
                          : nullptr;
    if (end != nullptr) break;
    const std::size_t length = end_ - begin_;
    if (!fill()) break;
    searched = begin_ + length;
  }
  if (end == nullptr && begin_ == end_) return false;
  before_last_ = {.offset = offset(), .number = number_};
  const std::size_t begin = begin_;
  const std::size_t stop = end == nullptr ? end_ : static_cast<std::size_t>(end - buffer_.data());
  begin_ = end == nullptr ? end_ : stop + 1;
  line.text = std::string_view(buffer_).substr(begin, stop - begin);
  line.number = ++number_;
  if (number_ == 1 && line.text.starts_with(kByteOrderMark)) {
    line.text.remove_prefix(kByteOrderMark.size());
  }
  if (line.text.ends_with('\r')) line.text.remove_suffix(1);
  return true;
}

bool LineReader::next_data(Line& line) {
  while (next(line)) {
    const std::string_view text = trimmed(line.text);
    if (!text.empty() && text.front() != '#') return true;
  }
  return false;
}

void LineReader::go_to(const Place& place) noexcept {
  number_ = place.number;
  if (place.offset >= buffer_offset_ && place.offset <= buffer_offset_ + end_) {
    begin_ = static_cast<std::size_t>(place.offset - buffer_offset_);
    return;
  }
  buffer_offset_ = place.offset;
  begin_ = end_ = 0;
}

/// Moves the rest of the buffer to its beginning and reads more of the file. Returns false at the
/// end of the file.
bool LineReader::fill() {
  const std::size_t rest = end_ - begin_;
  if (rest > kLongestLine) {
    throw InputError(fmt::format("{}:{}: the line has more than {} bytes", file_->name(),
                                 number_ + 1, kLongestLine));
  }
  buffer_.resize(std::max(buffer_.size(), rest + kBlock));
  if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, rest);
  buffer_offset_ += begin_;
  begin_ = 0;
  end_ = rest;
  const std::size_t bytes = file_->read(buffer_offset_ + rest, std::span(buffer_).subspan(rest));
  end_ += bytes;
  return bytes > 0;
}

}  // namespace splinecast::apps
