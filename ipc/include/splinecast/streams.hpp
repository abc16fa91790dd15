#pragma once

#include <string>
#include <vector>

#include "splinecast/options.hpp"

/// The streams of this host. A stream's name has 1 to 128 characters of A-Z a-z 0-9 . _ - and no
/// leading dot. Any thread may call these functions; they make system calls.
namespace [[gnu::visibility("default")]] splinecast {

/// Sorted names of all streams that have a region or a lock on this host. Ignores files whose names
/// are not valid, which any user can create. Throws OutOfResources or BadRegion if the folder
/// cannot be read.
[[nodiscard]] std::vector<std::string> stream_names();

/// Removes a stream: takes both locks, retires the regions, wakes readers, unlinks regions and lock
/// files; of a time law also the regions of its commanders. Throws, without changing anything:
/// BadRequest for an invalid name, NoSuchStream, StreamBusy if a writer of the stream or a
/// commander of the law lives, or BadRegion if one of its files is not trusted.
void remove_stream(const std::string& stream, const Trust& trust = {});

}  // namespace splinecast
