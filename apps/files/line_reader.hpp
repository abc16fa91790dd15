#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "apps/files/input_file.hpp"
#include "apps/files/lines.hpp"

namespace splinecast::apps {

/// Reads the lines of a file like Lines, with a buffer that is as long as the longest line, at
/// least 256 KiB.
class LineReader {
 public:
  /// Longest line, in bytes.
  static constexpr std::size_t kLongestLine = std::size_t{64} << 20U;

  /// The file must exist as long as the reader.
  explicit LineReader(InputFile& file) : file_(&file) {}

  /// The next line; its text is valid until the next call. Returns false at the end. Throws
  /// InputError for a line that is longer than kLongestLine, and as InputFile::read does.
  bool next(Line& line);
  /// The next line that is neither blank nor a comment.
  bool next_data(Line& line);

  /// A place between two lines.
  struct Place {
    std::uint64_t offset = 0;  ///< in the file, of the next line
    std::size_t number = 0;    ///< of the line before it, from 1
  };
  /// The place before the last line that was read.
  [[nodiscard]] const Place& before_last() const noexcept { return before_last_; }
  /// The place before the next line.
  [[nodiscard]] Place place() const noexcept { return {.offset = offset(), .number = number_}; }
  void go_to(const Place& place) noexcept;

  /// Bytes of the file before the next line.
  [[nodiscard]] std::uint64_t offset() const noexcept { return buffer_offset_ + begin_; }

 private:
  bool fill();

  InputFile* file_;
  std::string buffer_;
  std::uint64_t buffer_offset_ = 0;  ///< of the buffer in the file
  std::size_t begin_ = 0;            ///< of the next line in the buffer
  std::size_t end_ = 0;              ///< of the bytes read
  std::size_t number_ = 0;           ///< of the last line
  Place before_last_{};
};

}  // namespace splinecast::apps
