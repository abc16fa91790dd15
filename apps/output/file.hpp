#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace splinecast::apps {

/// When the output appears under its name.
enum class Writing : std::uint8_t {
  whole,    ///< when it is complete: until then, and on failure, the old file remains
  growing,  ///< from the start, so that others can follow it while it grows
};

/// Throws InputError if an output is also an input, or if two outputs are the same file, compared
/// by device and inode, through links. An empty output is standard output; the input `-` is
/// standard input. A file that is not regular, such as a terminal, may be both.
void require_separate(std::span<const std::string> outputs, std::span<const std::string> inputs);

/// An output file. Follows links. With Writing::whole, writes a regular file to a file without a
/// name (O_TMPFILE), or, if the file system does not support this, to a file `.splinecast.*` in the
/// same directory; commit() replaces the target by it and keeps the target's permissions. Writes
/// devices, pipes and files under /dev and /proc directly.
class OutputFile {
 public:
  /// Throws Failure, with the system's reason, if the file cannot be written.
  OutputFile(const std::string& path, Writing writing);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Discards what was not committed.
  ~OutputFile();

  [[nodiscard]] std::FILE* file() const noexcept { return file_; }

  /// Gives the file its name and closes it. Returns false and sets errno on failure.
  [[nodiscard]] bool commit();

 private:
  [[nodiscard]] int open_replacement();
  [[nodiscard]] int open_temporary();
  [[nodiscard]] bool give_name();

  std::string target_;     ///< after all links
  std::string temporary_;  ///< name of the file that replaces it; empty: written directly
  bool is_named_ = false;  ///< whether a file with this name exists
  std::FILE* file_ = nullptr;
};

}  // namespace splinecast::apps
