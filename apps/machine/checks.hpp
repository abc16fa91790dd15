#pragma once

#include <cstddef>
#include <vector>

#include "apps/machine/facts.hpp"
#include "apps/machine/finding.hpp"

/// Each documented limit of a machine, judged from its facts alone.
namespace splinecast::apps {

/// `another`: bytes of one more stream. `mapped`: bytes that a process must lock to map all
/// streams.
[[nodiscard]] Finding check_shared_memory(const MachineFacts& facts);
[[nodiscard]] Finding check_room(const MachineFacts& facts, std::size_t another);
[[nodiscard]] Finding check_locked_memory(const MachineFacts& facts, std::size_t mapped);
[[nodiscard]] Finding check_priority(const MachineFacts& facts);
[[nodiscard]] Finding check_remove_ipc(const MachineFacts& facts);
[[nodiscard]] Finding check_container(const MachineFacts& facts);
[[nodiscard]] Finding check_time_namespace(const MachineFacts& facts);
[[nodiscard]] Finding check_clock(const MachineFacts& facts);
[[nodiscard]] Finding check_governor(const MachineFacts& facts);
[[nodiscard]] Finding check_isolated_cpus(const MachineFacts& facts);
[[nodiscard]] Finding check_preemption(const MachineFacts& facts);
[[nodiscard]] Finding check_throttling(const MachineFacts& facts);
[[nodiscard]] Finding check_huge_pages(const MachineFacts& facts);
[[nodiscard]] Finding check_steal(const MachineFacts& facts);

/// All of them, in this order.
[[nodiscard]] std::vector<Finding> check_machine(const MachineFacts& facts, std::size_t another,
                                                 std::size_t mapped);

}  // namespace splinecast::apps
