#pragma once

namespace splinecast::ipc {

/// A file descriptor that is closed on exec and in every child that this process forks, so that
/// a lock held through it dies with this process and is nobody else's.
class OwnedDescriptor {
 public:
  OwnedDescriptor() = default;
  explicit OwnedDescriptor(int descriptor);
  OwnedDescriptor(OwnedDescriptor&& other) noexcept;
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept;
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  ~OwnedDescriptor();

  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  void close() noexcept;
  int descriptor_ = -1;
};

}  // namespace splinecast::ipc
