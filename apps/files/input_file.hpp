#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace splinecast::apps {

/// A file that is read by offset, in parts, so that its size does not matter. A pipe, or standard
/// input (`-`), is copied when it is opened: up to 16 MiB into memory, more into an unnamed
/// temporary file in $TMPDIR or /tmp, or into memory if there can be no such file. One thread uses
/// it.
class InputFile {
 public:
  /// Throws InputError if the file cannot be read.
  explicit InputFile(const std::string& path);
  InputFile(InputFile&&) noexcept;
  InputFile& operator=(InputFile&&) noexcept;
  ~InputFile();

  /// The path, with control characters escaped, or `<stdin>`.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Bytes when the file was opened. What is appended later is not read.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Reads bytes from an offset. Returns how many: fewer than requested only at the end. Reads with
  /// a system call and not through a mapping, so that a file that another process truncates is an
  /// error and not a SIGBUS. Throws InputError if the file has become shorter or cannot be read
  /// and, after require_same(), if it has changed.
  std::size_t read(std::uint64_t offset, std::span<char> out);

  /// From now on, read() throws InputError if the file has another size or time of modification
  /// than when it was opened. For a second pass.
  void require_same() noexcept { is_same_required_ = true; }

  /// The whole file as a view: mapped, or the copy of a pipe. Valid while this object lives, also
  /// after a move. The pages that are read count as memory of this process. Reading a page that
  /// another process has truncated away meanwhile raises SIGBUS.
  [[nodiscard]] std::string_view mapped();

 private:
  struct Storage;
  [[noreturn]] void refuse(int error) const;
  void copy_pipe(int descriptor);
  void append_to(int descriptor, std::string_view part) const;
  void require_unchanged() const;

  std::string name_;
  std::unique_ptr<Storage> storage_;
  std::uint64_t size_ = 0;
  bool is_same_required_ = false;
};

}  // namespace splinecast::apps
