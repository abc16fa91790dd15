#include "bench/harness/solved_streams.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "apps/process/descriptors.hpp"
#include "apps/streams/solve.hpp"

namespace splinecast::bench {
namespace {

std::string prefix() { return fmt::format("bench.many.{}.", getpid()); }

std::vector<std::string> names(std::size_t count) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(prefix() + std::to_string(i));
  return all;
}

}  // namespace

SolvedStreams::SolvedStreams(std::size_t count, const SolverOptions& options)
    : streams_(names(count)), remover_(streams_), solver_([&, wanted = prefix() + "*"] {
        return nlohmann::json(apps::run_solve(
            {.wanted = {wanted}, .solver = options, .sweep = kSweep, .quiet = true}));
      }) {
  apps::raise_descriptor_limit();
}

SolvedStreams::~SolvedStreams() {
  solver_.stop();
  (void)solver_.result();
}

std::vector<Reader> SolvedStreams::attach_readers(Time patience) const {
  std::vector<Reader> readers;
  readers.reserve(streams_.size());
  for (const std::string& stream : streams_) readers.emplace_back(stream, patience);
  return readers;
}

}  // namespace splinecast::bench
