#pragma once

#include <string>
#include <vector>

namespace splinecast::apps {

/// Removes what a verb leaves of its streams in shared memory, however it ends.
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
