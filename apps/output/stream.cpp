#include "apps/output/stream.hpp"

#include <stdio_ext.h>

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {

Output::Output(const std::string& path, Writing writing)
    : name_(path.empty() ? "standard output" : ipc::printable(path)), file_(stdout) {
  if (!path.empty()) file_ = output_file_.emplace(path, writing).file();
}

void Output::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void Output::flush() {
  if (std::fflush(file_) != 0) fail();
}

void Output::close() {
  flush();
  if (output_file_ && !output_file_->commit()) fail();
}

void Output::fail() const {
  if (errno == EPIPE) throw ClosedPipe("standard output was closed");
  if (errno == EINTR && stop_requested()) {
    if (file_ != nullptr)
      __fpurge(file_);  // flushing at exit would block if no process reads the output
    throw Interrupted(fmt::format("{}: interrupted", name_));
  }
  throw Failure(
      fmt::format("{}: cannot be written: {}", name_, std::generic_category().message(errno)));
}

void print_report(std::string_view text) {
  Output output("");
  output.write(text);
  output.close();
}

}  // namespace splinecast::apps
