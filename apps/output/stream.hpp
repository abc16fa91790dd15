#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "apps/output/file.hpp"

namespace splinecast::apps {

/// The output of a verb: a file (see OutputFile), or standard output for an empty path. Throws
/// Failure if it cannot be written, ClosedPipe if the reader closed the pipe, Interrupted if a stop
/// interrupts a write. With Writing::whole, discards the output unless close() is called.
class Output {
 public:
  explicit Output(const std::string& path, Writing writing = Writing::whole);
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output() = default;

  void write(std::string_view text);
  void flush();
  void close();

 private:
  [[noreturn]] void fail() const;
  std::string name_;
  std::optional<OutputFile> output_file_;
  std::FILE* file_;
};

/// Writes a whole report to standard output. Throws as Output does.
void print_report(std::string_view text);

}  // namespace splinecast::apps
