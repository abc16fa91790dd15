#pragma once

#include <string>

namespace splinecast::apps::record {

/// Sends a trigger to the recorder of this user with this name or process id, and waits until its
/// file has been begun. Root can trigger the recorders of others by their process id. Returns the
/// name of the file. Throws NoSuchStream if there is no such recorder, Failure if it belongs to
/// another user, ends meanwhile or cannot write a file now, TimeOut if it does not answer.
[[nodiscard]] std::string send_trigger(const std::string& recorder);

}  // namespace splinecast::apps::record
