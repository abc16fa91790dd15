#pragma once

#include <span>
#include <string>

#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// A commander region of which this process is the writer, created or taken over.
struct OwnedCommander {
  Region region;
  RegionLock lock;
  Word id;                  ///< stream id of the region
  std::span<Word> control;  ///< of the region

  OwnedCommander(Region mapped, const RegionHeader& header);
};

/// Takes over the region of that name, the result of commander_stream(), or creates one. `lock` is
/// its lock, whose unused file is removed on failure. Throws as the constructor of RateCommander
/// does.
[[nodiscard]] OwnedCommander own_commander(const std::string& name, const RegionAccess& access,
                                           const Trust& trust, OwnerLock& lock);

}  // namespace splinecast::ipc
