#include <algorithm>
#include <memory>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/stream_files.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"

namespace splinecast::apps {
namespace {

/// Removes one stream; what hinders it is said and does not keep the others.
int remove(const std::string& stream, const ipc::Trust& trust) {
  try {
    ipc::remove_stream(stream, trust);
    return kOk;
  } catch (const ipc::NoSuchStream& error) {
    say(error.what());
    return kNoStreamOrTimeOut;
  } catch (const ipc::BadRequest& error) {
    say(error.what());
    return kBadUsageOrInput;
  } catch (const ipc::StreamError& error) {
    say(error.what());
    return kFailed;
  }
}

}  // namespace

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
      int code = kOk;
      for (const std::string& stream : options->streams) {
        code = std::max(code, remove(stream, options->trust));
      }
      return code;
    };
  });
}

}  // namespace splinecast::apps
