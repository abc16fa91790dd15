#pragma once

#include <string>
#include <vector>

#include "splinecast/options.hpp"

/// The streams of this host. A stream's name has 1 to 128 of A-Z a-z 0-9 . _ - and no leading dot.
/// Any thread may call these functions; they make system calls.
namespace [[gnu::visibility("default")]] splinecast {

/// Names of all streams of which any region or lock exists on this host, sorted. Ignores files
/// whose names no stream can have, which any user can create. Throws OutOfResources or BadRegion if
/// the folder cannot be read.
[[nodiscard]] std::vector<std::string> stream_names();

/// Removes a stream: takes both locks, says `retired` to its readers and wakes them, unlinks
/// regions and lock files. Throws BadRequest for what is no stream's name, NoSuchStream, StreamBusy
/// if a writer of it lives, or BadRegion if a file under its names is not to be trusted; then
/// nothing has been changed.
void remove_stream(const std::string& stream, const Trust& trust = {});

}  // namespace splinecast
