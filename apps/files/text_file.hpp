#pragma once

#include <string>
#include <string_view>

namespace splinecast::apps {

/// A whole text file, or standard input (`-`), in memory. Throws InputError if it cannot be read.
class TextFile {
 public:
  explicit TextFile(const std::string& path);

  /// The path, or `<stdin>`.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::string_view text() const noexcept { return text_; }

 private:
  std::string name_;
  std::string text_;
};

}  // namespace splinecast::apps
