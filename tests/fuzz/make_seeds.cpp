#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "tests/fuzz/seed_streams.hpp"

/// make_seeds FOLDER: writes the seeds of the region targets.
int main(int argc, char** argv) {
  using namespace splinecast;
  if (argc != 2) return 2;
  try {
    for (const fuzz::Seed& seed : fuzz::make_seeds()) {
      const auto bytes = fuzz::encode(seed.image);
      std::ofstream file(std::string(argv[1]) + "/" + seed.name + ".region", std::ios::binary);
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
      if (!file.flush()) {
        std::fprintf(stderr, "make_seeds: cannot write to %s\n", argv[1]);
        return 1;
      }
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_seeds: %s\n", error.what());
    return 1;
  }
}
