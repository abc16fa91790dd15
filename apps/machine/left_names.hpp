#pragma once

#include <cstddef>
#include <string>

namespace splinecast::apps {

/// The state of a stream's name on this host.
enum class NameState {
  living,  ///< at least one writer is alive
  dead,  ///< its files are this user's and their owners are proven dead: no process holds the locks
  foreign,  ///< a file under it is another user's: whether its owner is alive is unknown
  hostile,  ///< a file under it is not a stream's file: neither used nor removed
  unknown,  ///< it could not be examined
};

/// A name and the files found under it.
struct LeftName {
  std::string stream;
  NameState state = NameState::dead;
  std::string why{};      ///< foreign, hostile, unknown: the file, and what is wrong with it
  std::size_t bytes = 0;  ///< size of its regular files
};

/// Examines the files under a stream's name, without opening those of other users. Makes system
/// calls. Throws BadRequest for an invalid name, NoSuchStream if there is no file, OutOfResources
/// if there is no free descriptor.
[[nodiscard]] LeftName look_at_name(const std::string& stream);

}  // namespace splinecast::apps
