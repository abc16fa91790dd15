#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "tests/fuzz/region_targets.hpp"

/// Tries region images as the fuzzers do, with any compiler: region_file FILE…, or one from
/// standard input. Exits with 1 if a promise is broken; dies as the target does.
namespace {

std::vector<std::uint8_t> bytes_of(std::istream& in) {
  const std::vector<char> all(std::istreambuf_iterator<char>(in), {});
  return {all.begin(), all.end()};
}

}  // namespace

int main(int argc, char** argv) {
  using namespace splinecast::fuzz;
  const char* name = "standard input";
  try {
    if (argc < 2) try_all(decode(bytes_of(std::cin)));
    for (int i = 1; i < argc; ++i) {
      name = argv[i];
      std::ifstream file(name, std::ios::binary);
      if (!file) {
        std::fprintf(stderr, "region_file: %s cannot be read\n", name);
        return 2;
      }
      try_all(decode(bytes_of(file)));
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "region_file: %s: %s\n", name, error.what());
    return 1;
  }
}
