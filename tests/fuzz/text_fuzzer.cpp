#include <cstddef>
#include <cstdint>

#include "tests/fuzz/text_targets.hpp"

// libFuzzer's entry point for the text target SPLINECAST_FUZZ_TARGET.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splinecast::fuzz::SPLINECAST_FUZZ_TARGET(
      {reinterpret_cast<const char*>(data), size});  // NOLINT(*-reinterpret-cast)
  return 0;
}
