#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/guard.hpp"

namespace splinecast::ipc {

/// The first member of each handle: a number that says which type it has, and that it lives. It
/// detects what a program passes by mistake, not an address that it must not read.
template <std::uint64_t Number>
class Mark {
 public:
  static constexpr std::uint64_t kNumber = Number;

  Mark() = default;
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;
  /// volatile: the compiler must not omit the store to an object that ends here.
  ~Mark() { *const_cast<volatile std::uint64_t*>(&number_) = 0; }

 private:
  std::uint64_t number_ = Number;
};

/// Throws BadArgument unless a handle is not null, aligned and of its type.
template <typename Handle>
Handle& require_handle(Handle* handle, const char* name) {
  using Plain = std::remove_const_t<Handle>;
  require_pointer(handle, name);
  std::uint64_t number = 0;
  std::memcpy(&number, static_cast<const void*>(handle), sizeof number);
  if (number != decltype(Plain::mark)::kNumber) {
    throw BadArgument(std::string(name) + " is not a living handle of this type");
  }
  return *handle;
}

/// Writes a new handle to `out`, or null if `make` throws.
template <typename Handle, typename Make>
int create_handle(Handle** out, const Make& make) noexcept {
  return guarded([&] {
    require_pointer(out, "out");
    *out = nullptr;
    *out = std::unique_ptr<Handle>(make()).release();
    return 0;
  });
}

template <typename Handle>
int destroy_handle(Handle* handle, const char* name) noexcept {
  return guarded([&] {
    if (handle != nullptr) delete &require_handle(handle, name);
    return 0;
  });
}

}  // namespace splinecast::ipc
