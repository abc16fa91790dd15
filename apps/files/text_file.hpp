#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace splinecast::apps {

/// A text file as one view. Maps a regular file; reads a pipe, or standard input (`-`), to its end.
/// Throws InputError if the file cannot be read.
class TextFile {
 public:
  explicit TextFile(const std::string& path);
  TextFile(TextFile&&) noexcept;
  TextFile& operator=(TextFile&&) noexcept;
  ~TextFile();

  /// The path, or `<stdin>`.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::string_view text() const noexcept { return text_; }

 private:
  struct Storage;
  [[noreturn]] void refuse(int error) const;
  [[nodiscard]] std::string read_to_end(int descriptor) const;

  std::string name_;
  std::unique_ptr<Storage> storage_;
  std::string_view text_;
};

}  // namespace splinecast::apps
