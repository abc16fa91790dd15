#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace splinecast::apps {

/// Folders for the sockets of a user's processes that exist, belong to the user and are closed to
/// others, the preferred one first: $XDG_RUNTIME_DIR if `user` is this process's, /run/user/UID,
/// /tmp/splinecast-UID.
[[nodiscard]] std::vector<std::string> runtime_folders(uid_t user);

/// The preferred one for this process; creates the one in /tmp if there is no other. Throws Failure
/// if its name is taken by another user's folder.
[[nodiscard]] std::string own_runtime_folder();

}  // namespace splinecast::apps
