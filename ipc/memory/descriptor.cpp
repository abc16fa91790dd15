#include "ipc/memory/descriptor.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <mutex>
#include <utility>
#include <vector>

namespace splinecast::ipc {
namespace {

/// All owned descriptors of this process. The mutex is held across fork, so that the child sees a
/// consistent list.
struct Registry {
  std::mutex mutex;
  std::vector<int> descriptors;
};

Registry& registry() {
  static Registry* const the_registry = [] {
    pthread_atfork([] { registry().mutex.lock(); }, [] { registry().mutex.unlock(); },
                   [] {
                     for (const int descriptor : registry().descriptors) ::close(descriptor);
                     registry().descriptors.clear();
                     registry().mutex.unlock();
                   });
    return new Registry;  // never destroyed: static destructors may fork
  }();
  return *the_registry;
}

/// The kernel closes the descriptors of a killed process from the highest number to the lowest. For
/// an event queue this takes milliseconds, on a busy machine seconds. Files may be locked: they get
/// numbers from this one on. Event queues get the lowest free number, which is lower unless the
/// process has that many other descriptors.
constexpr int kFirstOfFiles = 64;

/// Opens a file, with such a number if the limit of the process allows it.
int open_file(const char* path, int flags, mode_t mode) noexcept {
  const int low = ::open(path, flags | O_CLOEXEC, mode);
  if (low < 0 || low >= kFirstOfFiles) return low;
  const int high = fcntl(low, F_DUPFD_CLOEXEC, kFirstOfFiles);
  if (high < 0) return low;
  ::close(low);
  return high;
}

}  // namespace

template <typename Make>
OwnedDescriptor OwnedDescriptor::own(const Make& make) {
  Registry& owned = registry();
  const std::scoped_lock guard(owned.mutex);
  owned.descriptors.push_back(-1);
  const int descriptor = make();
  if (descriptor < 0) {
    owned.descriptors.pop_back();
  } else {
    owned.descriptors.back() = descriptor;
  }
  return OwnedDescriptor(descriptor);
}

OwnedDescriptor OwnedDescriptor::open(const std::string& path, int flags, mode_t mode) {
  return own([&] { return open_file(path.c_str(), flags, mode); });
}

OwnedDescriptor OwnedDescriptor::event_queue() {
  return own([] { return ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC); });
}

OwnedDescriptor::OwnedDescriptor(OwnedDescriptor&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

OwnedDescriptor& OwnedDescriptor::operator=(OwnedDescriptor&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

OwnedDescriptor::~OwnedDescriptor() { close(); }

void OwnedDescriptor::close() noexcept {
  if (descriptor_ < 0) return;
  const std::scoped_lock guard(registry().mutex);
  // In a forked child the list is empty, and the number may belong to another file.
  if (std::erase(registry().descriptors, descriptor_) > 0) {
    // Unlock explicitly: a child that was just forked may not have closed its duplicate of the
    // descriptor yet, which would keep the lock. Unlocking one duplicate unlocks all.
    struct flock whole_file {};
    whole_file.l_type = F_UNLCK;
    fcntl(descriptor_, F_OFD_SETLK, &whole_file);
    ::close(descriptor_);
  }
  descriptor_ = -1;
}

}  // namespace splinecast::ipc
