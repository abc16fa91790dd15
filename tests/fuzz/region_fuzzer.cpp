#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/region_targets.hpp"

// libFuzzer's entry point for the region target SPLINECAST_FUZZ_TARGET.

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splinecast::fuzz::SPLINECAST_FUZZ_TARGET(splinecast::fuzz::decode({data, size}));
  return 0;
}

/// Most mutations change words of the image; one in kPlain changes bytes of the file.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  constexpr unsigned kPlain = 16;
  if (seed % kPlain == 0) return LLVMFuzzerMutate(data, size, max_size);
  auto image = splinecast::fuzz::decode({data, size});
  std::mt19937_64 random(seed);
  splinecast::fuzz::mutate(image, random);
  const auto bytes = splinecast::fuzz::encode(image);
  if (bytes.size() > max_size) return size;
  std::ranges::copy(bytes, data);
  return bytes.size();
}
