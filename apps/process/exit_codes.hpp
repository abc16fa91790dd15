#pragma once

#include <stdexcept>

/// How the program ends, and the errors that lead there. `main` catches them.
namespace splinecast::apps {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;
inline constexpr int kBadUsageOrInput = 2;
inline constexpr int kFellShort = 3;
inline constexpr int kNoStreamOrTimeOut = 4;
inline constexpr int kInterrupted = 130;  ///< as a shell reports SIGINT

/// Wrong usage or wrong input: exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Something that should have worked did not: exit code 1.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Whoever read the output has had enough of it (`| head`): exit code 1, without a message.
class ClosedPipe : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A signal came before the work was done: exit code 130.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What was waited for did not come: exit code 4.
class TimeOut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace splinecast::apps
