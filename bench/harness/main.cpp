#include <benchmark/benchmark.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <string_view>

#include "bench/harness/blocks.hpp"

/// Without `--blocks` this is an ordinary program of Google Benchmark's, with its options.
///   splinecast_bench --blocks=N --out=FILE [--benchmark_min_time=S]
int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  int blocks = 0;
  std::string_view out;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const auto value = argument.substr(argument.find('=') + 1);
    if (argument.starts_with("--blocks=")) {
      std::from_chars(value.data(), value.data() + value.size(), blocks);
    } else if (argument.starts_with("--out=")) {
      out = value;
    } else {
      std::fprintf(stderr, "splinecast_bench: unknown argument %s\n", argv[i]);
      return 2;
    }
  }
  if ((blocks > 0) == out.empty()) {
    std::fprintf(stderr, "splinecast_bench: --blocks=N and --out=FILE belong together\n");
    return 2;
  }
  try {
    if (blocks > 0) {
      splinecast::bench::run_blocks(blocks, std::string(out));
    } else {
      benchmark::RunSpecifiedBenchmarks();
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
