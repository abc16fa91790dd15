#include <memory>

#include "splinecast/ipc/stream_files.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"

namespace splinecast::apps {

void add_rm(CLI::App& program, Action& action) {
  struct Options {
    std::vector<std::string> streams;
    ipc::Trust trust;
  };
  auto options = std::make_shared<Options>();
  auto* verb = program.add_subcommand("rm", "Remove streams whose writers have ended");
  verb->add_option("STREAM", options->streams, "Streams to remove")->required();
  add_trust(*verb, options->trust);
  verb->callback([&action, options] {
    action = [options] {
      for (const std::string& stream : options->streams) {
        ipc::remove_stream(stream, options->trust);
      }
      return kOk;
    };
  });
}

}  // namespace splinecast::apps
