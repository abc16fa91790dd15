#include <algorithm>
#include <memory>

#include "apps/cli/guarded.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/process/exit_codes.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

void add_rm(Command& verb, Action& action) {
  struct Options {
    std::vector<std::string> streams;
    Trust trust;
  };
  auto options = std::make_shared<Options>();
  verb.option("STREAM", options->streams, "Names of the streams to remove").required();
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    action = [options] {
      int code = kOk;
      for (const std::string& stream : options->streams) {
        // Continues after a failure.
        code = std::max(code, run_guarded([&] {
                          remove_stream(stream, options->trust);
                          return kOk;
                        }));
      }
      return code;
    };
  });
}

const Verb rm_verb("rm", 120, "Remove streams whose writers have ended", add_rm);

}  // namespace

}  // namespace splinecast::apps
