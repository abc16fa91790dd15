#include "apps/process/signals.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"
#include "tests/apps/streams/life.hpp"

/// A signal ends every verb: with a clean exit if possible, otherwise by force.
namespace splinecast::apps {
namespace {

using testing::TestFolder;

/// A process that catches signals and reports them through a pipe, but does not end.
class Stubborn {
 public:
  explicit Stubborn(const std::function<void()>& catch_signals) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      catch_signals();
      (void)!write(ends[1], "r", 1);
      while (!stop_requested()) poll(nullptr, 0, 1000);  // until a signal; 1 s if it came before
      const unsigned left = alarm(0);
      alarm(left);
      (void)!write(ends[1], left > 0 ? "a" : "s", 1);
      for (;;) pause();
    }
    close(ends[1]);
    pipe_ = ends[0];
  }
  Stubborn(const Stubborn&) = delete;
  Stubborn& operator=(const Stubborn&) = delete;
  ~Stubborn() {
    close(pipe_);
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  /// The next report of the process: `r` after it has installed its handlers; then, after a signal,
  /// `a` if an alarm is set or `s` if not.
  [[nodiscard]] char next() const {
    char said = 0;
    return read(pipe_, &said, 1) == 1 ? said : '-';
  }
  void signal(int number) const { kill(pid_, number); }

  /// The exit status of the process; nothing if it still runs after 30 s.
  std::optional<int> wait() {
    constexpr int kBoundMilliseconds = 30'000;
    pollfd ended{
        .fd = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), .events = POLLIN, .revents = 0};
    const bool has_ended = poll(&ended, 1, kBoundMilliseconds) == 1;
    close(ended.fd);
    if (!has_ended) return std::nullopt;
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
};

TEST(Signals, ASecondSignalEndsAProcessThatIgnoresTheFirst) {
  for (const auto& [first, second] :
       {std::pair{SIGINT, SIGINT}, {SIGTERM, SIGTERM}, {SIGINT, SIGTERM}}) {
    Stubborn process(catch_stop_signals);
    ASSERT_EQ(process.next(), 'r');
    process.signal(first);
    ASSERT_EQ(process.next(), 'a');
    process.signal(second);
    const auto status = process.wait();
    ASSERT_TRUE(status) << "still runs after a second signal";
    ASSERT_TRUE(WIFSIGNALED(*status)) << *status;
    EXPECT_EQ(WTERMSIG(*status), second);
  }
}

TEST(Signals, AnAlarmEndsAProcessThatIgnoresASignalForSeconds) {
  Stubborn process(catch_stop_signals);
  ASSERT_EQ(process.next(), 'r');
  process.signal(SIGTERM);
  const auto status = process.wait();
  ASSERT_TRUE(status) << "still runs after a signal";
  ASSERT_TRUE(WIFEXITED(*status)) << *status;
  EXPECT_EQ(WEXITSTATUS(*status), kInterrupted);
}

TEST(Signals, AStepOfAShutdownRestartsTheAlarmButSetsNoneBefore) {
  const pid_t process = fork();
  if (process == 0) {
    catch_stop_signals();
    extend_shutdown();
    if (alarm(0) != 0) _exit(100);  // no signal has arrived
    raise(SIGTERM);
    alarm(1000);
    extend_shutdown();
    _exit(static_cast<int>(alarm(0)));
  }
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, 0), process);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_GT(WEXITSTATUS(status), 0);
  EXPECT_LE(WEXITSTATUS(status), 5);
}

TEST(Signals, AChildProcessSetsNoAlarmUnlessItsParentIsDead) {
  const pid_t parent = getpid();
  Stubborn child([parent] { catch_stop_signals_as_child_of(parent); });
  ASSERT_EQ(child.next(), 'r');
  child.signal(SIGTERM);
  EXPECT_EQ(child.next(), 's');
  Stubborn orphan([] { catch_stop_signals_as_child_of(1); });
  ASSERT_EQ(orphan.next(), 'r');
  orphan.signal(SIGTERM);
  EXPECT_EQ(orphan.next(), 'a');
}

/// Name and state of a process from /proc, such as `splinecast S`; empty after it has ended.
std::string name_and_state(pid_t pid) {
  const std::string stat = testing::read_file("/proc/" + std::to_string(pid) + "/stat");
  const auto open = stat.find('(');
  const auto close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos) return {};
  return stat.substr(open + 1, close - open - 1) + " " + stat[close + 2];
}

/// Whether a process catches SIGTERM: SigCgt has bit n - 1 for signal n.
bool catches_signals(pid_t pid) {
  const std::string status = testing::read_file("/proc/" + std::to_string(pid) + "/status");
  constexpr std::string_view kField = "SigCgt:";
  const auto at = status.find(kField);
  return at != std::string::npos &&
         (std::stoull(status.substr(at + kField.size()), nullptr, 16) >> (SIGTERM - 1) & 1U) != 0;
}

/// A full pipe without a reader.
class FullPipe {
 public:
  FullPipe() : path_(folder_.path("pipe")) {
    if (mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("no FIFO");
    end_ = open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    const std::array<char, 4096> some{};
    while (write(end_, some.data(), some.size()) > 0) {
    }
    while (write(end_, some.data(), 1) > 0) {
    }
  }
  FullPipe(const FullPipe&) = delete;
  FullPipe& operator=(const FullPipe&) = delete;
  ~FullPipe() { close(end_); }

  /// Starts `splinecast` with the pipe as standard output, and waits until it sleeps.
  [[nodiscard]] Process start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> shell{"-c", R"(out="$1"; shift; exec "$0" "$@" >"$out")",
                                   SPLINECAST_PROGRAM, path_};
    shell.insert(shell.end(), arguments.begin(), arguments.end());
    Process process("/bin/sh", shell);
    EXPECT_TRUE(await([&] { return name_and_state(process.pid()) == "splinecast S"; }))
        << arguments[0];
    return process;
  }

 private:
  TestFolder folder_;
  std::string path_;
  int end_ = -1;
};

/// Sends a signal to a process and waits for its end. Returns its exit code, or 128 plus the number
/// of the signal that killed it, like a shell.
int code_after(Process& process, int signal) {
  process.signal(signal);
  const Ended ended = process.wait();
  return ended.signal != 0 ? 128 + ended.signal : ended.code;
}

/// Waits until this process has no child. As a subreaper it also adopts the children of processes
/// that have ended.
bool has_no_children() {
  return await([] {
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    return waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD;
  });
}

class EveryVerb : public Life, public ::testing::WithParamInterface<int> {};

TEST_P(EveryVerb, WithoutCleanUpEndsByASignalAlsoWhileItsOutputIsBlocked) {
  const FullPipe pipe;
  ASSERT_EQ(run({"replay", file_, "--stream", name(), "--rate", "max", "--clock", "recorded",
                 "--embedded"})
                .code,
            0);
  const auto polynomials = folder_.write("p.csv", "duration,x^0,x^1\n9,0,1\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"fit", file_, "--dt", "0.001"},
        {"fit", file_, "--method", "smoothing", "--lambda", "auto", "--dt", "0.001"},
        {"methods", "--against", polynomials},
        {"info", name()},
        {"ls", "--json"},
        {"doctor"}}) {
    Process process = pipe.start(arguments);
    EXPECT_EQ(code_after(process, GetParam()), 128 + GetParam()) << arguments[0];
  }
  const auto long_lasting = folder_.write("l.csv", "duration,x^0,x^1\n9000,0,1\n");
  Process measuring({"methods", "--against", long_lasting});
  ASSERT_TRUE(await([&] { return name_and_state(measuring.pid()) == "splinecast R"; }));
  EXPECT_EQ(code_after(measuring, GetParam()), 128 + GetParam());
  Process removing({"rm", name()});  // may end before the signal or by it
  const int code = code_after(removing, GetParam());
  EXPECT_TRUE(code == 0 || code == 128 + GetParam()) << code;
}

TEST_P(EveryVerb, ThatSolvesExitsCleanlyOnASignal) {
  Process one(solve());
  one.await_message("waiting for a producer");
  EXPECT_EQ(code_after(one, GetParam()), kOk);
  Process many({"solve", name(), name() + ".*"});
  ASSERT_TRUE(await([&] { return catches_signals(many.pid()); }));
  EXPECT_EQ(code_after(many, GetParam()), kOk);
}

TEST_P(EveryVerb, ThatSendsOrSamplesExitsWith130IfItIsInterrupted) {
  const int signal = GetParam();
  {
    Process replaying({"replay", file_, "--stream", name(), "--wait", "1000"});
    ASSERT_TRUE(await([&] { return info(name()).is_object(); }));
    EXPECT_EQ(code_after(replaying, signal), kInterrupted) << "waiting for a solver";
  }
  Process solver(solve());
  solver.await_message("waiting for a producer");
  {
    Process sampling({"sample", name(), "--rate", "10", "--count", "100", "--wait", "1000"});
    ASSERT_TRUE(await([&] { return catches_signals(sampling.pid()); }));
    EXPECT_EQ(code_after(sampling, signal), kInterrupted) << "waiting for a stream";
  }
  Process replaying({"replay", file_, "--stream", name(), "--loop", "1000"});
  ASSERT_TRUE(await([&] { return field("solver", "consumed") > 5; }));
  const FullPipe pipe;
  Process stuck = pipe.start({"sample", name(), "--rate", "1000", "--count", "1000000000"});
  EXPECT_EQ(code_after(stuck, signal), kInterrupted) << "a full pipe";
  Process live({"sample", name(), "--rate", "1", "--count", "1000"});
  ASSERT_TRUE(await([&] { return catches_signals(live.pid()); }));
  EXPECT_EQ(code_after(live, signal), kInterrupted) << "a live stream";
  EXPECT_EQ(code_after(replaying, signal), kInterrupted) << "sending";
  EXPECT_EQ(code_after(solver, signal), kOk);
}

TEST_P(EveryVerb, OfManyProcessesEndsAllOfThemAndExitsWith130) {
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"demo", "--seconds", "1000"},
        {"demo", "--chaos", "--seconds", "1000", "--json"},
        {"latency", "--duration", "3000"},
        {"soak", "--streams", "3", "--seconds", "1000", "--json"}}) {
    Process process(arguments);
    const std::string stream =
        arguments[0] + "." + std::to_string(process.pid()) + (arguments[0] == "soak" ? ".0" : "");
    // A starved machine may refuse all waypoints: they are too late.
    const auto consumed = [&] {
      const auto now = info(stream);
      return now.is_object() && now["solver"].is_object()
                 ? now["solver"]["consumed"].get<ipc::Word>()
                 : 0;
    };
    ASSERT_TRUE(await([&] { return consumed() > 10; })) << arguments[0];
    EXPECT_EQ(code_after(process, GetParam()), kInterrupted) << arguments[0];
    EXPECT_TRUE(has_no_children()) << arguments[0];
    EXPECT_THROW(remove_stream(stream), NoSuchStream) << "not removed";
  }
}

TEST_P(EveryVerb, OfManyProcessesEndsAllOfThemAtASecondSignal) {
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  Process process({"demo", "--chaos", "--seconds", "1000"});
  const std::string stream = "demo." + std::to_string(process.pid());
  ASSERT_TRUE(await([&] { return info(stream).is_object(); }));
  process.signal(GetParam());
  EXPECT_EQ(code_after(process, GetParam()) & ~127, 128);
  EXPECT_TRUE(has_no_children());
  try {
    remove_stream(stream);
  } catch (const NoSuchStream&) {  // the first signal has already removed it
  }
}

TEST(Signals, CtrlCLetsTheProcessesOfDemoExitCleanly) {
  const Ended ended = testing::interrupt_in_time(
      [] {
        // A new session and process group, as in a terminal: the signal is sent to all processes.
        Process demo("/usr/bin/setsid",
                     {SPLINECAST_PROGRAM, "demo", "--seconds", "1000", "--json"});
        const std::string stream = "demo." + std::to_string(demo.pid());
        EXPECT_TRUE(await([&] {
          const auto now = info(stream);
          return now.is_object() && now["solver"].is_object() && now["solver"]["interpolated"] > 10;
        }));
        return demo;
      },
      [](const Process& demo) { return -demo.pid(); });
  EXPECT_EQ(ended.code, kInterrupted) << ended.err;
  const auto found = nlohmann::json::parse(ended.out, nullptr, false);
  ASSERT_TRUE(found.is_object()) << ended.out << ended.err;
  EXPECT_TRUE(found["interrupted"].get<bool>());
  EXPECT_EQ(found["readers"].size(), 2U);
}

INSTANTIATE_TEST_SUITE_P(On, EveryVerb, ::testing::Values(SIGINT, SIGTERM), [](const auto& tested) {
  return std::string(tested.param == SIGINT ? "SIGINT" : "SIGTERM");
});

}  // namespace
}  // namespace splinecast::apps
