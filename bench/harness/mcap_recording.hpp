#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace splinecast::bench {

/// An MCAP file of waypoints of seven dimensions, compressed with zstd: of rosbag2's JointState in
/// CDR, or the JSON of a stream that this program recorded. The destructor removes the file.
class McapRecording {
 public:
  enum class Kind { joint_states, recorded_stream };
  static constexpr std::size_t kRows = 1'000'000;

  explicit McapRecording(Kind kind);
  McapRecording(const McapRecording&) = delete;
  McapRecording& operator=(const McapRecording&) = delete;
  ~McapRecording() { std::filesystem::remove(path_); }

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::size_t bytes() const { return std::filesystem::file_size(path_); }

 private:
  std::filesystem::path path_;
};

}  // namespace splinecast::bench
