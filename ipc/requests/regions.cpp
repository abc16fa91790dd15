#include "ipc/requests/regions.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "ipc/layout/common_control.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/requests/record.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {

RequestRegions::RequestRegions(std::string of, RegionKind kind, const Trust& trust,
                               const Requesters& known)
    : of_(std::move(of)), kind_(kind), trust_(trust), known_(&known) {}

std::string RequestRegions::stream_of(const std::string& name) const {
  return kind_ == RegionKind::stopper ? stopper_stream(of_, name) : commander_stream(of_, name);
}

/// Drops regions that are retired and, when the names have changed, those whose name belongs to
/// another region now. One whose file was only deleted is kept: its request stays in force.
bool RequestRegions::drop_gone() {
  const auto is_replaced = [this](const Source& source) {
    if (!has_news() || !known_->names_of(of_).contains(source.name)) return false;
    try {
      const auto header = peek_header(stream_of(source.name), kind_, trust_);
      return header && header->stream_id != source.id;
    } catch (const StreamError&) {
      return false;
    }
  };
  return std::erase_if(sources_, [&](const Source& source) {
           return load(source.control[kRetired], std::memory_order_acquire) != 0 ||
                  is_replaced(source);
         }) > 0;
}

/// Maps the region of a name. Returns why it cannot be used, if so.
std::optional<RequestRegions::Unusable> RequestRegions::open(const std::string& name) {
  try {
    const std::string stream = stream_of(name);
    auto [region, header, layout] = open_request(stream, kind_, false, trust_);
    require_same_clock(header, stream);
    region.close_descriptor();
    const auto control = words_at(region.bytes(), layout.control, kSeparationWords);
    sources_.push_back(
        {.name = name, .id = header.stream_id, .region = std::move(region), .control = control});
  } catch (const NoSuchStream&) {
    return std::nullopt;  // it was just removed
  } catch (const OutOfResources& error) {
    return Unusable{.name = name, .why = error.what(), .is_unread = true};
  } catch (const StreamError& error) {
    return Unusable{.name = name, .why = error.what()};
  }
  return std::nullopt;
}

/// Lists the names that have come, and forgets unusable ones that are gone.
void RequestRegions::find_untried() {
  const auto& names = known_->names_of(of_);
  std::erase_if(unusable_, [&](const Unusable& each) { return !names.contains(each.name); });
  std::set<std::string_view> tried;
  for (const Source& source : sources_) tried.insert(source.name);
  for (const Unusable& each : unusable_) tried.insert(each.name);
  untried_.clear();
  for (const std::string& name : names) {
    if (!tried.contains(name)) untried_.push_back(name);
  }
  std::ranges::reverse(untried_);
}

bool RequestRegions::poll() {
  const bool has_dropped = drop_gone();
  if (has_news()) find_untried();
  seen_ = known_->version();
  const std::size_t before = sources_.size();
  std::size_t tries = 0;
  for (; tries < kTries && !untried_.empty(); ++tries) {
    auto unusable = open(untried_.back());
    untried_.pop_back();
    if (unusable) unusable_.push_back(std::move(*unusable));
  }
  const std::size_t again = std::min(kTries - tries, unusable_.size());
  for (std::size_t i = 0; i < again && !unusable_.empty(); ++i) {
    retry_ = (retry_ + 1) % unusable_.size();
    auto unusable = open(unusable_[retry_].name);
    if (unusable) {
      unusable_[retry_] = std::move(*unusable);
    } else {
      unusable_.erase(unusable_.begin() + std::ptrdiff_t(retry_));
    }
  }
  return has_dropped || sources_.size() > before;
}

bool RequestRegions::calls() const noexcept {
  return has_news() || !untried_.empty() || std::ranges::any_of(sources_, [](const Source& source) {
           return load(source.control[kRecordSequence], std::memory_order_seq_cst) != source.seen;
         });
}

}  // namespace splinecast::ipc
