#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/time.hpp"
#include "tests/fixtures/preloaded/disk_control.hpp"

namespace splinecast::campaign::record {

/// A folder for the files of one run, removed at the end.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  [[nodiscard]] std::string path(const std::string& file) const { return path_ / file; }
  /// The paths of its files *.mcap, sorted.
  [[nodiscard]] std::vector<std::string> recordings() const;

 private:
  std::filesystem::path path_;
};

/// The disk of a recorder, as faulty_disk.cpp makes it.
class Disk {
 public:
  /// `path`: of the file with its state.
  explicit Disk(std::string path);
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  ~Disk();

  /// For Program: so that its writes are to this disk.
  [[nodiscard]] std::vector<std::string> environment() const;
  void fill(std::int64_t room) noexcept;
  void slow_down(std::int64_t rate) noexcept { control_->rate = rate; }
  /// Makes it a good disk.
  void repair() noexcept;
  [[nodiscard]] std::int64_t refused() const noexcept { return control_->refused; }

 private:
  std::string path_;
  testing::DiskControl* control_ = nullptr;
};

/// The program `splinecast` in a process of its own, with its output in files. Killed when this
/// object is destroyed.
class Program {
 public:
  /// `files`: path of its output, without extension. `environment`: further variables.
  Program(std::vector<std::string> arguments, std::string files,
          std::vector<std::string> environment = {});
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void signal(int number) const noexcept;
  /// Waits until standard error contains a text. Returns false if it ends before that.
  [[nodiscard]] bool await_message(const std::string& text);
  /// Waits for its end: the exit code, or minus the number of the signal that killed it; nothing if
  /// it does not end.
  [[nodiscard]] std::optional<int> wait();
  [[nodiscard]] std::string out() const { return read(files_ + ".out"); }
  [[nodiscard]] std::string err() const { return read(files_ + ".err"); }
  /// The memory that it uses now, in KiB.
  [[nodiscard]] std::size_t memory() const;

 private:
  [[nodiscard]] static std::string read(const std::string& path);
  [[nodiscard]] bool has_ended();

  std::string files_;
  pid_t pid_ = -1;
  std::optional<int> code_;
};

/// How long a program may take for what it does at once, also on a busy machine.
inline constexpr Time kPatience = std::chrono::minutes(10);

}  // namespace splinecast::campaign::record
