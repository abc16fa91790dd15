#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace splinecast::apps::record {

/// The names of a recorder's files: `run.mcap` becomes `run-0002.mcap`, `run.underrun-0001.mcap`.
class FileNames {
 public:
  explicit FileNames(std::string path);

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// The next name of a kind, which may be empty, for which no file exists. Its number is at least
  /// `least`, and larger than all that next() has returned for this kind. Throws Failure if there
  /// is none up to 999999.
  [[nodiscard]] std::string next(std::string_view kind, std::size_t least);

  /// The last name of a kind has not been used.
  void forget_last(std::string_view kind) { --last_[std::string(kind)]; }

  /// Throws Failure if the folder is not one in which files can be created.
  void require_folder() const;

 private:
  std::string path_;
  std::string stem_;                                      ///< path without the extension
  std::string extension_;                                 ///< with its dot
  std::map<std::string, std::size_t, std::less<>> last_;  ///< numbers, by kind
};

}  // namespace splinecast::apps::record
