#pragma once

#include <atomic>
#include <boost/interprocess/anonymous_shared_memory.hpp>
#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>

namespace splinecast::apps {

/// One object in memory that a process shares with the children it forks afterwards.
template <typename T>
class Shared {
 public:
  Shared()
      : region_(boost::interprocess::anonymous_shared_memory(sizeof(T))),
        object_(new (region_.get_address()) T{}) {}

  [[nodiscard]] T& operator*() const noexcept { return *object_; }
  [[nodiscard]] T* operator->() const noexcept { return object_; }

 private:
  static_assert(std::is_trivially_destructible_v<T>);
  boost::interprocess::mapped_region region_;
  T* object_;
};

/// A log of fixed capacity from a child process to its parent. The child pushes entries; the parent
/// reads them after the child has ended.
template <typename T>
class SharedLog {
 public:
  explicit SharedLog(std::size_t capacity)
      : capacity_(capacity),
        region_(boost::interprocess::anonymous_shared_memory(kHeader + capacity * sizeof(T))) {}

  /// Maps every page into this process, so that push() causes no page fault. Clears the log: call
  /// it before the first push.
  void touch() const noexcept { std::memset(region_.get_address(), 0, region_.get_size()); }

  /// Returns false if the log is full.
  [[nodiscard]] bool push(const T& entry) noexcept {
    if (size() == capacity_) return false;
    entries_at(size()) = entry;
    ++size();
    return true;
  }

  [[nodiscard]] std::span<const T> entries() const noexcept { return {&entries_at(0), size()}; }

 private:
  static_assert(std::is_trivially_copyable_v<T>);
  static constexpr std::size_t kHeader = 64;

  // The pages start as zeros: an empty log.
  [[nodiscard]] std::size_t& size() const noexcept {
    return *static_cast<std::size_t*>(region_.get_address());
  }
  [[nodiscard]] T& entries_at(std::size_t i) const noexcept {
    auto* const first = static_cast<std::byte*>(region_.get_address()) + kHeader;
    return reinterpret_cast<T*>(first)[i];  // NOLINT(*-reinterpret-cast)
  }

  std::size_t capacity_;
  boost::interprocess::mapped_region region_;
};

}  // namespace splinecast::apps
