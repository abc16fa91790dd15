#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "apps/process/exit_codes.hpp"
#include "apps/process/use.hpp"
#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/built_with.hpp"

namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;

/// Flips one to four bits of a text.
std::string flipped(std::string file, std::mt19937& random) {
  const unsigned flips = 1 + random() % 4;
  for (unsigned i = 0; i < flips; ++i) {
    char& byte = file[random() % file.size()];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << (random() % 8)));
  }
  return file;
}

/// Whether `part` is `whole` without some of its messages.
bool is_part(const std::vector<KeptMessage>& part, const std::vector<KeptMessage>& whole) {
  auto at = whole.begin();
  return std::ranges::all_of(part, [&](const KeptMessage& message) {
    at = std::find(at, whole.end(), message);
    return at != whole.end() && (++at, true);
  });
}

/// Reads and recovers a damaged file. Returns an error if a wrong message comes out.
std::string try_damaged(const std::string& file, const std::vector<KeptMessage>& written) {
  try {
    if (!is_part(messages_of(file), written)) return "the reader gave another message";
  } catch (const apps::InputError&) {
    // Refused: that is right.
  }
  try {
    const Recovered recovered = recover_text(file);
    mcap::Reader reader("recovered", bytes_of(recovered.file));
    if (reader.ended_early()) return "the recovered file is not complete";
    if (!is_part(rest_of(reader), written)) return "recovery kept another message";
  } catch (const apps::InputError& refused) {
    if (file.starts_with("\x89MCAP0\r\n")) return std::string("not recovered: ") + refused.what();
  }
  return "";
}

/// Ends with exit code 0 if no flip leads to a wrong message, a crash, or more memory.
[[noreturn]] void try_flips(unsigned seed, int count) {
  std::mt19937 random(seed);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // 64 MiB more than now. The largest chunk has less than 1 KiB.
  const rlim_t most = apps::process_use(getpid())->mapped_bytes + (rlim_t{64} << 20U);
  const rlimit limit{most, most};
  if (setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(2);
#endif
  std::vector<SmallRecording> recordings;
  for (const auto compression :
       {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
    recordings.emplace_back(compression);
  }
  for (int i = 0; i < count; ++i) {
    const SmallRecording& recording = recordings[static_cast<std::size_t>(i) % recordings.size()];
    const std::string error = try_damaged(flipped(recording.file, random), recording.messages);
    if (error.empty()) continue;
    std::fprintf(stderr, "flip %d of seed %u: %s\n", i, seed, error.c_str());
    std::_Exit(1);
  }
  std::_Exit(0);
}

TEST(McapFlips, AHundredThousandFlipsGiveNoWrongMessageAndNeedNoMoreMemory) {
  REQUIRE_MCAP();
  constexpr unsigned kSeed = 20261;
  alarm(250);  // a hang ends the child
  EXPECT_EXIT(try_flips(kSeed, 100'000), ::testing::ExitedWithCode(0), "");
  alarm(0);
}

}  // namespace
}  // namespace splinecast::testing
