#pragma once

#include <string>
#include <vector>

namespace splinecast::apps {

/// Removes the streams of a verb from shared memory at the end of the verb, also after an error.
class StreamRemover {
 public:
  explicit StreamRemover(std::vector<std::string> streams);
  StreamRemover(const StreamRemover&) = delete;
  StreamRemover& operator=(const StreamRemover&) = delete;
  ~StreamRemover();

 private:
  std::vector<std::string> streams_;
};

}  // namespace splinecast::apps
