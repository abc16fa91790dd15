#include <cstddef>
#include <cstdint>

#include "tests/fuzz/text_targets.hpp"

// libFuzzer's entry to one text target: SPLINECAST_FUZZ_TARGET names it.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splinecast::fuzz::SPLINECAST_FUZZ_TARGET(
      {reinterpret_cast<const char*>(data), size});  // NOLINT(*-reinterpret-cast)
  return 0;
}
