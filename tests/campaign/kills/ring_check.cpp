#include "tests/campaign/kills/ring_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/process/messages.hpp"
#include "ipc/layout/check.hpp"
#include "ipc/ring/item.hpp"

namespace splinecast::campaign {

RingCheck::RingCheck(const Plan& plan, ReaderFacts& facts)
    : plan_(&plan),
      facts_(&facts),
      region_(ipc::Region::open(plan.stream, ipc::RegionKind::waypoints, false)),
      header_(ipc::copy_header(region_.bytes())),
      ring_(region_.bytes(), ipc::checked_ring_layout(header_, region_.bytes().size())),
      item_(Payload::kDimensions) {}

bool RingCheck::is_finished() const noexcept {
  const ipc::Word written = ring_.written();
  return written > 0 && ring_.kind(written - 1) == ipc::ItemKind::finish;
}

void RingCheck::look(ipc::Word back) {
  const ipc::Word written = ring_.written();
  if (back >= written) return;
  const ipc::Word i = written - 1 - back;
  if (!ring_.observe(i, item_) || item_.kind != ipc::ItemKind::waypoint) return;
  ++facts_->items;
  const auto number = plan_->payload.number_at(item_.time);
  const bool is_in_order = plan_->is_live() || number == i;
  if (number && is_in_order &&
      std::ranges::equal(std::span(item_.values).first(Payload::kDimensions),
                         plan_->payload.position_of(*number))) {
    return;
  }
  ++facts_->torn;
  apps::say(fmt::format("'{}': item {} of the ring, at {}, differs from the one that was sent",
                        plan_->stream, i, item_.time.count()));
}

}  // namespace splinecast::campaign
