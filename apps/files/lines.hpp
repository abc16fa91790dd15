#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace splinecast::apps {

/// The first bytes of some texts, which are not part of the first line.
inline constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// One line of a file.
struct Line {
  std::size_t number = 0;  ///< from 1; 0: there is no line
  std::string_view text;
};

/// Iterates over the lines of a text. Accepts `\n` and `\r\n`, and a last line without either.
/// Skips a byte order mark.
class Lines {
 public:
  explicit Lines(std::string_view text);
  bool next(Line& line);
  /// The next line that is neither blank nor a comment.
  bool next_data(Line& line);

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Splits a line into its fields, which are views into the line.
using Split = void (*)(std::string_view line, std::vector<std::string_view>& fields);

/// Split at runs of blanks.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields);
/// Split at separators that are not within double quotes.
void split_at_commas(std::string_view line, std::vector<std::string_view>& fields);
void split_at_semicolons(std::string_view line, std::vector<std::string_view>& fields);
void split_at_tabs(std::string_view line, std::vector<std::string_view>& fields);

}  // namespace splinecast::apps
