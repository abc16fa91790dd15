#include "tests/campaign/kills/journal.hpp"

#include <boost/interprocess/anonymous_shared_memory.hpp>
#include <memory>

#include "ipc/memory/store_hook.hpp"

namespace splinecast::campaign {

#ifdef SPLINECAST_HOOKS
bool has_hooks() noexcept { return true; }
void kill_before_store(std::uint64_t number) noexcept { ipc::kill_before_store(number); }
#else
bool has_hooks() noexcept { return false; }
void kill_before_store(std::uint64_t /*number*/) noexcept {}
#endif

SharedJournal::SharedJournal()
    : memory_(boost::interprocess::anonymous_shared_memory(sizeof(Journal))),
      journal_(std::construct_at(static_cast<Journal*>(memory_.get_address()))) {}

WithinStep::WithinStep(Journal& journal, Step step) noexcept
    : journal_(&journal), is_armed_(journal.armed == step) {
  if (is_armed_) kill_before_store(journal.store);
}

WithinStep::~WithinStep() {
  if (is_armed_) kill_before_store(0);
}

void WithinStep::survived() noexcept {
  if (is_armed_) journal_->armed = Step::none;
}

}  // namespace splinecast::campaign
