#include "ipc/python/held.hpp"

#include <pthread.h>
#include <unistd.h>

namespace splinecast::python {
namespace {

pid_t remembered_process = 0;

void remember() noexcept { remembered_process = getpid(); }

/// Runs before any role is made: when the module is loaded.
const bool is_watching_forks = (remember(), pthread_atfork(nullptr, nullptr, remember) == 0);

}  // namespace

pid_t current_process() noexcept { return is_watching_forks ? remembered_process : getpid(); }

}  // namespace splinecast::python
