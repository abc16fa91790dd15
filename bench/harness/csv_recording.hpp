#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace splinecast::bench {

/// A CSV file of a recording: times in ns, and values with the digits of a float, as recorders
/// write them. The destructor removes the file.
class CsvRecording {
 public:
  static constexpr std::size_t kRows = 200'000;

  explicit CsvRecording(std::size_t dimensions);
  CsvRecording(const CsvRecording&) = delete;
  CsvRecording& operator=(const CsvRecording&) = delete;
  ~CsvRecording() { std::filesystem::remove(path_); }

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::size_t bytes() const { return std::filesystem::file_size(path_); }

 private:
  std::filesystem::path path_;
};

/// The recording of seven dimensions that all benchmarks share.
[[nodiscard]] const CsvRecording& csv_recording();

}  // namespace splinecast::bench
