#pragma once

#include <sys/types.h>

#include <optional>

namespace splinecast::ipc {

/// Whose regions this process uses: its own user's and root's, and those of `owner` if set. A
/// region must also be a regular file that neither its group nor others may write.
struct Trust {
  std::optional<uid_t> owner{};
};

}  // namespace splinecast::ipc
