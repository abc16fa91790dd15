#include "apps/streams/remover.hpp"

#include <exception>
#include <utility>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {

StreamRemover::StreamRemover(std::vector<std::string> streams) : streams_(std::move(streams)) {}

StreamRemover::~StreamRemover() {
  for (const std::string& stream : streams_) {
    extend_shutdown();
    try {
      remove_stream(stream);
    } catch (const std::exception& error) {
      say(error.what());
    }
  }
}

}  // namespace splinecast::apps
