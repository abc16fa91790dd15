#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>

#include "ipc/memory/separation.hpp"

namespace splinecast::fuzz {

/// A copy of a region between two inaccessible pages. A read or a store outside of it ends the
/// process, and so does a store to it while it is read-only.
class GuardedBytes {
 public:
  explicit GuardedBytes(std::span<const ipc::Word> words)
      : size_(words.size_bytes()),
        inner_((size_ + ipc::kPage - 1) / ipc::kPage * ipc::kPage),
        outer_(static_cast<std::byte*>(mmap(nullptr, inner_ + 2 * ipc::kPage, PROT_NONE,
                                            MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {
    if (outer_ == MAP_FAILED) throw std::bad_alloc();  // NOLINT(*-cast)
    set_writable(true);
    std::ranges::copy(std::as_bytes(words), span().data());
  }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;
  ~GuardedBytes() { munmap(outer_, inner_ + 2 * ipc::kPage); }

  /// The bytes. They end at the second inaccessible page. If they fill whole pages, they also begin
  /// at the end of the first one.
  [[nodiscard]] std::span<std::byte> span() const {
    return {outer_ + ipc::kPage + inner_ - size_, size_};
  }

  void set_writable(bool writable) {
    if (inner_ == 0) return;
    if (mprotect(outer_ + ipc::kPage, inner_, writable ? PROT_READ | PROT_WRITE : PROT_READ) != 0) {
      throw std::bad_alloc();
    }
  }

 private:
  std::size_t size_;
  std::size_t inner_;
  std::byte* outer_;
};

}  // namespace splinecast::fuzz
