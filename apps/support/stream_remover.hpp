#pragma once

#include <exception>
#include <string>
#include <utility>

#include "splinecast/ipc/stream_files.hpp"
#include "support/output.hpp"

namespace splinecast::apps {

/// Removes what a verb with a stream of its own leaves in shared memory, however it ends.
class StreamRemover {
 public:
  explicit StreamRemover(std::string stream) : stream_(std::move(stream)) {}
  StreamRemover(const StreamRemover&) = delete;
  StreamRemover& operator=(const StreamRemover&) = delete;
  ~StreamRemover() {
    try {
      ipc::remove_stream(stream_);
    } catch (const std::exception& error) {
      say(error.what());
    }
  }

 private:
  std::string stream_;
};

}  // namespace splinecast::apps
