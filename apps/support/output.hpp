#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "splinecast/core/dimension_kind.hpp"
#include "splinecast/core/state.hpp"
#include "splinecast/core/time.hpp"
#include "support/output_file.hpp"

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

/// Writes samples as CSV: `t_ns,p[0],…,v[0],…,a[0],…,j[0],…`, where there are quaternions also
/// `omega[0],…,alpha[0],…`, three for each; numbers in the shortest form that reads back exactly.
class SampleWriter {
 public:
  /// Writes the header, with a last column `status` if asked for.
  SampleWriter(Output& output, std::size_t dimensions, core::DimensionKinds kinds,
               bool with_status);

  /// Writes a row, of a state as it is read. An empty `status` writes none.
  void write(core::Time time, const core::State& state, std::string_view status = {});

 private:
  Output* output_;
  core::DimensionKinds kinds_;
  std::vector<core::AngularMotion> motions_;  ///< of the quaternions
  fmt::memory_buffer line_;
};

/// A line on stderr that overwrites itself, where stderr is a terminal; else nothing.
class Progress {
 public:
  Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows the text, at most ten times a second.
  void show(std::string_view text);

 private:
  bool terminal_;
  bool shown_ = false;
  core::Time next_{};
};

/// A message on stderr: `splinecast: …`. What its lines hold of other people's names and texts is
/// printed as ipc::printable() has it.
void say(std::string_view text);

}  // namespace splinecast::apps
