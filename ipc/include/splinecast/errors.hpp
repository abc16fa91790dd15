#pragma once

#include <stdexcept>

/// What opening, attaching, stepping, finishing and removing may throw. `append`, `replace_from`,
/// `start_from`, `sample`, `preview` and `sample_many` never throw: they return statuses.
namespace [[gnu::visibility("default")]] splinecast {

/// Base of the errors below. The message names the stream and the offending values.
class StreamError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// There is no stream of this name, or none came in time.
class NoSuchStream : public StreamError {
 public:
  using StreamError::StreamError;
};

/// Another living process owns the region that was to be written or removed.
class StreamBusy : public StreamError {
 public:
  using StreamError::StreamError;
};

/// A region that must not be used: another layout, a wrong size, an owner or a mode that is not
/// trusted, another time namespace.
class BadRegion : public StreamError {
 public:
  using StreamError::StreamError;
};

/// No memory, shared memory or file descriptors are left now: trying again later may succeed.
class OutOfResources : public BadRegion {
 public:
  using BadRegion::BadRegion;
};

/// What was asked for cannot be, or contradicts the stream as it stands: a usage error.
class BadRequest : public StreamError {
 public:
  using StreamError::StreamError;
};

}  // namespace splinecast
