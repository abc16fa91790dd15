#pragma once

#include <stdexcept>

/// Exit codes of the program, and the exceptions that cause them. run_guarded() catches them.
namespace splinecast::apps {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;
inline constexpr int kBadUsageOrInput = 2;
inline constexpr int kFellShort = 3;
inline constexpr int kNoStreamOrTimeOut = 4;
inline constexpr int kIncomplete = 5;  ///< nothing differs, but something is lost or not compared
inline constexpr int kInterrupted = 130;  ///< as a shell reports SIGINT

/// Wrong usage or wrong input: exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An operation failed: exit code 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The reader of the output closed the pipe (`| summary`): exit code 1, without a message.
class ClosedPipe : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A signal arrived before the work was done: exit code 130.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A wait timed out: exit code 4.
class TimeOut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace splinecast::apps
