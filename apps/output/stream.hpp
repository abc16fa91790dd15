#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "apps/output/file.hpp"

namespace splinecast::apps {

/// Where a verb's data goes: a file, see OutputFile, or standard output for an empty path. Throws
/// Failure if it cannot be written; without `close`, what was to be written whole is dropped.
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
