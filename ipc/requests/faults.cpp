#include "ipc/requests/faults.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace splinecast::ipc {

void RequestFaults::set(std::set<std::string> present) {
  for (const std::string& text : present) {
    if (!present_.contains(text)) new_.push_back(text);
  }
  present_ = std::move(present);
}

void RequestFaults::take(std::vector<std::string>& out) {
  std::ranges::move(new_, std::back_inserter(out));
  new_.clear();
}

}  // namespace splinecast::ipc
