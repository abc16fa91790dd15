#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "tests/fuzz/region_targets.hpp"

/// region_file FILE…: runs all targets on region images, or on one image from standard input, with
/// any compiler. Exits with 1 if a promise is broken. A crash of a target ends the program.
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
        std::fprintf(stderr, "region_file: cannot read %s\n", name);
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
