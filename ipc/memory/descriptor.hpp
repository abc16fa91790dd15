#pragma once

#include <sys/types.h>

#include <string>

namespace splinecast::ipc {

/// A file descriptor that is closed on exec, and in every child that this process forks. So a lock
/// held through it belongs to this process only, and the kernel releases it when this process ends.
class OwnedDescriptor {
 public:
  OwnedDescriptor() = default;

  /// Calls open(2) with O_CLOEXEC. If it fails, get() is −1 and errno is set. A concurrent fork
  /// waits until the descriptor is registered for closing in children.
  [[nodiscard]] static OwnedDescriptor open(const std::string& path, int flags, mode_t mode = 0);

  /// The same with inotify_init1(2): an event queue that is read without waiting.
  /// Closing it may take long: release the locks of this process before.
  [[nodiscard]] static OwnedDescriptor event_queue();

  OwnedDescriptor(OwnedDescriptor&& other) noexcept;
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept;
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  ~OwnedDescriptor();

  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  explicit OwnedDescriptor(int descriptor) noexcept : descriptor_(descriptor) {}
  template <typename Make>
  [[nodiscard]] static OwnedDescriptor own(const Make& make);
  void close() noexcept;
  int descriptor_ = -1;
};

}  // namespace splinecast::ipc
