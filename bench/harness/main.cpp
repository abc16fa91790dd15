#include <benchmark/benchmark.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bench/harness/blocks.hpp"

namespace {

/// The options of this program in addition to Google Benchmark's.
struct Arguments {
  int blocks = 0;  ///< 0: an ordinary run
  std::string_view out{};
};

/// The parsed options; nullopt, and a message on standard error, if one is invalid.
std::optional<Arguments> parse(std::span<char* const> given) {
  Arguments arguments;
  for (const std::string_view argument : given) {
    const auto value = argument.substr(argument.find('=') + 1);
    if (argument.starts_with("--blocks=")) {
      std::from_chars(value.data(), value.data() + value.size(), arguments.blocks);
    } else if (argument.starts_with("--out=")) {
      arguments.out = value;
    } else {
      std::fprintf(stderr, "splinecast_bench: unknown argument %s\n", argument.data());
      return std::nullopt;
    }
  }
  if ((arguments.blocks > 0) == arguments.out.empty()) {
    std::fprintf(stderr, "splinecast_bench: --blocks=N and --out=FILE must be given together\n");
    return std::nullopt;
  }
  return arguments;
}

}  // namespace

/// Without `--blocks` this is an ordinary Google Benchmark program, with its options.
///   splinecast_bench --blocks=N --out=FILE [--benchmark_min_time=S]
int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const auto arguments = parse(std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
  if (!arguments) return 2;
  try {
    if (arguments->blocks > 0) {
      splinecast::bench::run_blocks(arguments->blocks, std::string(arguments->out));
    } else {
      benchmark::RunSpecifiedBenchmarks();
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
