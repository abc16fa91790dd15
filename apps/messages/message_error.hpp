#pragma once

#include <stdexcept>

namespace splinecast::apps {

/// A message that cannot be decoded. The text says at which byte or field, and why; the reader of
/// the file adds the name of the file and the number of the message.
class MessageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace splinecast::apps
