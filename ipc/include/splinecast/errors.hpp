#pragma once

#include <stdexcept>

/// Exceptions of opening, attaching, stepping, finishing and removing. `append`, `replace_from`,
/// `start_from`, `sample`, `preview` and `sample_many` never throw: they return a status.
namespace [[gnu::visibility("default")]] splinecast {

/// Base of the errors below. The message names the stream and the offending values.
class StreamError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// There is no stream of this name, or none appeared before the timeout.
class NoSuchStream : public StreamError {
 public:
  using StreamError::StreamError;
};

/// The time law that a stream follows has been removed: those that follow it already continue, and
/// no other reader or solver can.
class LawLost : public NoSuchStream {
 public:
  using NoSuchStream::NoSuchStream;
};

/// Another living process owns the region to be written or removed.
class StreamBusy : public StreamError {
 public:
  using StreamError::StreamError;
};

/// A region that must not be used: another layout, a wrong size, an untrusted owner or mode,
/// another time namespace.
class BadRegion : public StreamError {
 public:
  using StreamError::StreamError;
};

/// No memory, shared memory or file descriptor is left: a later retry may succeed.
class OutOfResources : public BadRegion {
 public:
  using BadRegion::BadRegion;
};

/// A usage error: invalid arguments, or options that contradict the existing stream.
class BadRequest : public StreamError {
 public:
  using StreamError::StreamError;
};

}  // namespace splinecast
