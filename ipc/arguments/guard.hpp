#pragma once

#include <stdexcept>
#include <string>

/// Turns the exceptions of C++ into the errors of the C interface.
namespace splinecast::ipc {

/// An argument of a C function that cannot be used.
class BadArgument : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Writes the message of the exception that is being handled to the thread's last error. Returns
/// its splinecast_error. Call it in a handler only.
[[nodiscard]] int record_failure() noexcept;

/// The thread's last error: "" if there was none.
[[nodiscard]] const char* last_failure() noexcept;

/// Runs the body of a C function: returns what it returns, or records its exception and returns
/// that one's splinecast_error.
template <typename Body>
[[nodiscard]] int guarded(const Body& body) noexcept {
  try {
    return body();
  } catch (...) {
    return record_failure();
  }
}

/// The same for a body that returns a text: null after an exception.
template <typename Body>
[[nodiscard]] const char* guarded_text(const Body& body) noexcept {
  try {
    return body();
  } catch (...) {
    (void)record_failure();
    return nullptr;
  }
}

}  // namespace splinecast::ipc
