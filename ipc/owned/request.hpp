#pragma once

#include <span>
#include <string>

#include "ipc/layout/header.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/options.hpp"

namespace splinecast::ipc {

/// The region of a commander or a stopper of which this process is the writer, created or taken
/// over.
struct OwnedRequest {
  Region region;
  RegionLock lock;
  Word id;                  ///< stream id of the region
  std::span<Word> control;  ///< of the region

  OwnedRequest(Region mapped, const RegionHeader& header);
};

/// Takes over the region of that name, the result of commander_stream() or stopper_stream(), or
/// creates one. `lock` is its lock, whose unused file is removed on failure. Throws as the
/// constructor of RateCommander does.
[[nodiscard]] OwnedRequest own_request(const std::string& name, RegionKind kind,
                                       const RegionAccess& access, const Trust& trust,
                                       OwnerLock& lock);

}  // namespace splinecast::ipc
