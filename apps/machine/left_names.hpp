#pragma once

#include <cstddef>
#include <string>

namespace splinecast::apps {

/// What a stream's name stands for on this host.
enum class NameState {
  living,  ///< a writer lives, or one waits for the other
  dead,    ///< its files are this user's and their owners are proven dead: nobody holds their locks
  foreign,  ///< a file under it is another user's: whether its owner lives is that user's to say
  hostile,  ///< a file under it is no file of a stream: neither used nor removed
  unknown,  ///< it could not be looked at
};

/// A name and what was found under it.
struct LeftName {
  std::string stream;
  NameState state = NameState::dead;
  std::string why{};      ///< foreign, hostile, unknown: the file, and what is wrong with it
  std::size_t bytes = 0;  ///< size of its regular files
};

/// Looks at the files under a stream's names, without opening any that is not this user's. System
/// calls. Throws BadRequest for an invalid name, NoSuchStream if there is nothing, OutOfResources
/// where no descriptor is left to look with.
[[nodiscard]] LeftName look_at_name(const std::string& stream);

}  // namespace splinecast::apps
