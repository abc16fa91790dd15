#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace splinecast::testing {

/// How long anything that must happen may take on a busy machine before a test gives up on it.
inline constexpr std::chrono::seconds kPatience{60};

/// What a process left when it had ended.
struct Ended {
  int code = -1;    ///< exit code; −1 if a signal killed it
  int signal = 0;   ///< the signal that killed it
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// A running process. Killed when it goes out of scope, and with the test.
class Process {
 public:
  /// Starts `splinecast`.
  explicit Process(const std::vector<std::string>& arguments);
  /// Starts any program, by its path.
  Process(const std::string& program, const std::vector<std::string>& arguments);
  Process(Process&& other) noexcept;
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  Process& operator=(Process&&) = delete;
  ~Process();

  [[nodiscard]] pid_t pid() const { return pid_; }
  void signal(int number) const;

  /// Waits until standard error has said `text`. Fails the test if the process ends or falls
  /// silent.
  void await_message(const std::string& text);

  /// Waits until standard output has `count` lines. Fails the test likewise.
  void await_lines(std::ptrdiff_t count);

  /// Waits for its end.
  Ended wait();

 private:
  bool read_some();
  void await_until(const std::function<bool()>& is_there, const std::string& wanted);

  pid_t pid_ = -1;
  int out_ = -1;
  int err_ = -1;
  std::string out_text_;
  std::string err_text_;
};

/// Runs `splinecast` with these arguments to its end.
Ended run(const std::vector<std::string>& arguments);

/// Waits until the condition holds, looking every millisecond. Returns false after kPatience.
bool await(const std::function<bool()>& condition);

/// `info --json` of a stream; null if there is none.
nlohmann::json info(const std::string& stream);

/// A stream name that no other test uses; removes what is left of the stream at the end.
class TestStream {
 public:
  TestStream();
  TestStream(const TestStream&) = delete;
  TestStream& operator=(const TestStream&) = delete;
  ~TestStream();
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

/// A folder for the files of one test, removed at the end.
class TestFolder {
 public:
  TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder();
  /// Path of a file in it.
  [[nodiscard]] std::string path(const std::string& file) const { return path_ + "/" + file; }
  /// Writes a file and returns its path.
  std::string write(const std::string& file, const std::string& text) const;

 private:
  std::string path_;
};

std::string read_file(const std::string& path);

}  // namespace splinecast::testing
