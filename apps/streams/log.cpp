#include "apps/streams/log.hpp"

#include <fmt/format.h>

#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps {

using nlohmann::ordered_json;

StreamLog::StreamLog(const std::string& stream, std::uint64_t stream_id, const Trust& trust)
    : board_(stream, stream_id, trust),
      law_(ipc::law_of(board_.header(), trust)),
      settled_(board_.reader(), is_live(ipc::stream_clock(board_.header()))),
      items_(board_.reader().dimensions()) {}

void StreamLog::look() {
  settled_.look(law_ ? law_->final_until(MonotonicClock().now()) : Time::max());
}

ipc::Verification StreamLog::verify(const Condition& end) {
  look();
  return ipc::verify({.window = ipc::window_options(board_.header()),
                      .kinds = ipc::dimension_kinds(board_.header()),
                      .items = items_,
                      .segments = settled_.segments(),
                      .summary = settled_.summary(),
                      .end = end,
                      .rules = board_.header().rules});
}

std::string in_words(const ipc::Verification& found) {
  if (!found.first) return fmt::format("{} segments solved again, all equal", found.equal);
  const ipc::Difference& at = *found.first;
  return fmt::format(
      "{} segments solved again and equal, then segment {} ({} to {} ns) differs in {}: {} "
      "published, {} solved",
      found.equal, at.segment, at.left.count(), at.right.count(), at.what, at.published, at.solved);
}

ordered_json to_json(const ipc::Verification& found) {
  ordered_json json{{"equal", found.equal}, {"difference", nullptr}};
  if (!found.first) return json;
  const ipc::Difference& at = *found.first;
  json["difference"] = {{"segment", at.segment},        {"left_ns", at.left.count()},
                        {"right_ns", at.right.count()}, {"what", at.what},
                        {"published", at.published},    {"solved", at.solved}};
  return json;
}

}  // namespace splinecast::apps
