#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/cli/verb.hpp"
#include "apps/files/text_file.hpp"
#include "apps/mcap/input/recover.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

struct RecoverOptions {
  std::string file;
  std::optional<std::string> output;
  bool json = false;
};

/// `1 chunk`, `2 chunks`.
std::string counted(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// `run.mcap` becomes `run.recovered.mcap`.
std::string default_output(const std::string& file) {
  const std::filesystem::path path(file);
  const std::string extension = path.has_extension() ? path.extension().string() : ".mcap";
  return (path.parent_path() / path.stem()).string() + ".recovered" + extension;
}

mcap::Recovery recover_to(const std::string& path, const TextFile& file) {
  Output output(path);
  Progress progress;
  std::uint64_t written = 0;
  const auto write = [&](std::span<const std::byte> bytes) {
    // NOLINTNEXTLINE(*-reinterpret-cast)
    output.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    written += bytes.size();
    progress.show(fmt::format("{}: {} MB written", ipc::printable(path), written / 1'000'000));
    return true;
  };
  mcap::Recovery recovery =
      mcap::recover(file.name(), std::as_bytes(std::span(file.text())), write);
  output.close();
  return recovery;
}

ordered_json to_json(const std::string& file, const std::string& output,
                     const mcap::Recovery& found) {
  const auto lost_messages =
      found.lost_messages ? ordered_json(*found.lost_messages) : ordered_json(nullptr);
  return {
      {"file", file},
      {"output", ipc::printable(output)},
      {"was_whole", found.is_whole()},
      {"was_cut_off", !found.was_complete},
      {"kept",
       {{"messages", found.kept.messages},
        {"channels", found.kept.channels},
        {"schemas", found.kept.schemas},
        {"chunks", found.kept.chunks},
        {"metadata", found.kept.metadata},
        {"attachments", found.kept.attachments}}},
      {"lost",
       {{"chunks", found.lost_chunks}, {"bytes", found.lost_bytes}, {"messages", lost_messages}}},
      {"damages", found.damages},
      {"further_damages", found.further_damages}};
}

void say_all(const std::string& file, const std::string& output, const mcap::Recovery& found) {
  for (const std::string& damage : found.damages) say(damage);
  if (found.further_damages > 0) {
    say(fmt::format("{}: and {}", file, counted(found.further_damages, "further damage")));
  }
  if (!found.was_complete) say(file + ": is cut off: it has no footer");
  if (found.is_whole()) say(file + ": is whole");
  say(fmt::format("{}: kept {} of {} in {}, {}, {}", output,
                  counted(found.kept.messages, "message"), counted(found.kept.channels, "channel"),
                  counted(found.kept.chunks, "chunk"),
                  counted(found.kept.metadata, "metadata record"),
                  counted(found.kept.attachments, "attachment")));
  if (found.is_whole()) return;
  say(fmt::format("{}: lost {}, {}, {}", file, counted(found.lost_chunks, "damaged chunk"),
                  counted(found.lost_bytes, "byte"),
                  found.lost_messages ? counted(*found.lost_messages, "message")
                                      : "an unknown number of messages"));
}

int run_recover(const RecoverOptions& options) {
  const std::string output = options.output.value_or(default_output(options.file));
  require_separate(std::array{output}, std::array{options.file});
  const TextFile file(options.file);
  const mcap::Recovery found = recover_to(output, file);
  say_all(file.name(), output, found);
  if (options.json) print_report(to_json(file.name(), output, found).dump(2) + "\n");
  return kOk;
}

void add_recover(Command& verb, Action& action) {
  auto options = std::make_shared<RecoverOptions>();
  verb.option("FILE", options->file, "MCAP file that is cut off or damaged; - for standard input")
      .required();
  verb.option("-o,--output", options->output,
              "File to write (default: FILE with .recovered before its extension)")
      .type("FILE");
  verb.flag("--json", options->json, "Print what was kept and lost as JSON");
  verb.callback([&action, options] {
    if (options->file == "-" && !options->output) {
      throw UsageError("recover", "standard input needs --output");
    }
    action = [options] { return run_recover(*options); };
  });
}

const Verb recover_verb("recover", 115, "Make a complete file of a damaged MCAP file", add_recover);

}  // namespace

}  // namespace splinecast::apps
