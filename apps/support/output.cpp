#include "support/output.hpp"

#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <iterator>
#include <system_error>
#include <utility>

#include "splinecast/ipc/clock.hpp"
#include "splinecast/ipc/names.hpp"
#include "support/exit_codes.hpp"
#include "support/signals.hpp"

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
      __fpurge(file_);  // else output that nobody reads would block the process at exit
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

SampleWriter::SampleWriter(Output& output, std::size_t dimensions, core::DimensionKinds kinds,
                           bool with_status)
    : output_(&output), kinds_(std::move(kinds)), motions_(kinds_.quaternions().size()) {
  auto to = std::back_inserter(line_);
  fmt::format_to(to, "t_ns");
  for (const char letter : {'p', 'v', 'a', 'j'}) {
    for (std::size_t d = 0; d < dimensions; ++d) fmt::format_to(to, ",{}[{}]", letter, d);
  }
  for (const char* const word : {"omega", "alpha"}) {
    for (std::size_t i = 0; i < 3 * motions_.size(); ++i) fmt::format_to(to, ",{}[{}]", word, i);
  }
  fmt::format_to(to, "{}\n", with_status ? ",status" : "");
  output_->write({line_.data(), line_.size()});
}

void SampleWriter::write(core::Time time, const core::State& state, std::string_view status) {
  line_.clear();
  auto to = std::back_inserter(line_);
  fmt::format_to(to, "{}", time.count());
  for (const double value : state.values()) fmt::format_to(to, ",{}", value);
  for (std::size_t q = 0; q < motions_.size(); ++q) {
    motions_[q] = core::angular_motion(kinds_.quaternions()[q], state.position(), state.velocity(),
                                       state.acceleration());
  }
  for (const auto part : {&core::AngularMotion::velocity, &core::AngularMotion::acceleration}) {
    for (const core::AngularMotion& motion : motions_) {
      for (const double value : motion.*part) fmt::format_to(to, ",{}", value);
    }
  }
  if (!status.empty()) fmt::format_to(to, ",{}", status);
  line_.push_back('\n');
  output_->write({line_.data(), line_.size()});
}

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::string_view text) {
  if (!terminal_) return;
  const core::Time now = ipc::MonotonicClock().now();
  if (now < next_) return;
  constexpr core::Time kPeriod = std::chrono::milliseconds(100);
  next_ = now + kPeriod;
  shown_ = true;
  fmt::print(stderr, "\r\033[K{}", text);
  std::fflush(stderr);
}

void say(std::string_view text) {
  std::string lines = "splinecast: ";
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    lines += ipc::printable(text.substr(0, end)) + '\n';
    text.remove_prefix(end + 1);
  }
  lines += ipc::printable(text) + '\n';
  std::fputs(lines.c_str(), stderr);  // a message that cannot be written is no reason to end
}

}  // namespace splinecast::apps
