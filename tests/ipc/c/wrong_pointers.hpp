#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "splinecast.h"

namespace splinecast::testing {

/// One call of a C function with one wrong argument.
struct WrongCall {
  std::string function;
  std::string argument;  ///< its name, which the message has
  std::string kind;      ///< what is wrong with it
  std::function<int()> call;
};

/// The result of a function that returns a text, as that of one that returns a result.
inline int of_text(const char* text) { return text == nullptr ? SPLINECAST_ERROR_ARGUMENT : 0; }

/// Calls of functions with wrong pointers. `call` takes the pointer.
class WrongPointers {
 public:
  enum class Null { wrong, allowed };

  /// A pointer to objects: null, and not aligned.
  template <typename T, typename Call>
  void pointer(const char* function, const char* argument, const Call& call,
               Null null = Null::wrong) {
    if (null == Null::wrong) {
      add(function, argument, "null", [call] { return call(static_cast<T*>(nullptr)); });
    }
    if constexpr (alignof(T) > 1) {
      add(function, argument, "misaligned",
          [call] { return call(reinterpret_cast<T*>(memory() + 1)); });
    }
  }
  /// A handle: also one of another type, and memory that is not one.
  template <typename T, typename Call>
  void handle(const char* function, const char* argument, const Call& call, void* other,
              Null null = Null::wrong) {
    if (null == Null::wrong) {
      add(function, argument, "null", [call] { return call(static_cast<T*>(nullptr)); });
    }
    add(function, argument, "misaligned",
        [call] { return call(reinterpret_cast<T*>(memory() + 1)); });
    add(function, argument, "other type", [call, other] { return call(static_cast<T*>(other)); });
    add(function, argument, "not a handle",
        [call] { return call(reinterpret_cast<T*>(memory())); });
  }
  /// A text: null, and one that is too long.
  template <typename Call>
  void text(const char* function, const char* argument, const Call& call, Null null = Null::wrong) {
    pointer<const char>(function, argument, call, null);
    add(function, argument, "long", [call] { return call(std::string(5000, 'x').c_str()); });
  }
  void add(std::string function, std::string argument, std::string kind,
           std::function<int()> call) {
    calls.push_back({std::move(function), std::move(argument), std::move(kind), std::move(call)});
  }

  std::vector<WrongCall> calls;

 private:
  /// Zeros, with the alignment of every type.
  static std::byte* memory() {
    alignas(std::max_align_t) static std::byte zeros[1024] = {};
    return zeros;
  }
};

}  // namespace splinecast::testing
