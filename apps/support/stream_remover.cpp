#include "support/stream_remover.hpp"

#include <exception>
#include <utility>

#include "splinecast/ipc/stream_files.hpp"
#include "support/output.hpp"

namespace splinecast::apps {

StreamRemover::StreamRemover(std::vector<std::string> streams) : streams_(std::move(streams)) {}

StreamRemover::~StreamRemover() {
  for (const std::string& stream : streams_) {
    try {
      ipc::remove_stream(stream);
    } catch (const std::exception& error) {
      say(error.what());
    }
  }
}

}  // namespace splinecast::apps
