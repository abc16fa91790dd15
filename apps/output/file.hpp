#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>

namespace splinecast::apps {

/// When a file gets its name.
enum class Writing : std::uint8_t {
  whole,    ///< at once when it is complete: until then, and upon failure, the old file stays
  growing,  ///< as it is written, to be followed meanwhile
};

/// Throws InputError if an output is also an input, or two outputs are the same file: by device and
/// inode, through links. An empty output is standard output, `-` as input is standard input. What
/// is no regular file, such as a terminal, may be both.
void require_separate(std::span<const std::string> outputs, std::span<const std::string> inputs);

/// A file that is written. Links are followed to their end. Regular files that are written whole
/// get their bytes in a file without a name, or, where the file system has none such, with a name
/// `.splinecast.*` beside them; permissions of the file that it replaces are kept. Devices, pipes
/// and what lies under /dev and /proc are written directly.
class OutputFile {
 public:
  /// Throws Failure, with the system's reason, if it cannot be written.
  OutputFile(const std::string& path, Writing writing);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Drops what was not committed.
  ~OutputFile();

  [[nodiscard]] std::FILE* file() const noexcept { return file_; }

  /// Gives the file its name and closes it. Returns false and sets errno upon failure.
  [[nodiscard]] bool commit();

 private:
  [[nodiscard]] int open_replacement();
  [[nodiscard]] int open_temporary();
  [[nodiscard]] bool give_name();

  std::string target_;     ///< behind all links
  std::string temporary_;  ///< name of what will replace it; empty: written directly
  bool is_named_ = false;  ///< whether there is a file under that name
  std::FILE* file_ = nullptr;
};

}  // namespace splinecast::apps
