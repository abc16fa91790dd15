#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "ipc/mapping/owner_lock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"
#include "tests/apps/streams/forbidden.hpp"

/// Users who share a stream, and processes that hold locks or descriptors of an owner.
namespace splinecast::apps {
namespace {

using testing::Confinement;
using testing::PrivateSharedMemory;
using testing::Process;
using testing::TestStream;

constexpr gid_t kTeam = 54321;
const std::vector<std::string> kShared{"--mode", "0640", "--group", std::to_string(kTeam)};

class ForbiddenSharing : public Forbidden {
 protected:
  [[nodiscard]] std::vector<std::string> shared(std::vector<std::string> verb) const {
    verb.insert(verb.end(), kShared.begin(), kShared.end());
    return verb;
  }
  Confinement writer_{.user = 12345, .group = 12345, .groups = {kTeam}};
  Confinement member_{.user = 23456, .group = 23456, .groups = {kTeam}};
  Confinement stranger_{.user = 34567, .group = 34567};
};

TEST_F(ForbiddenSharing, OnlyMembersOfTheGroupCanRead) {
  REQUIRE_ROOT();
  const PrivateSharedMemory memory("64m");
  Process solver = memory.start(shared({"solve", "a"}), writer_);
  solver.await_message("waiting for a producer");
  attack(memory, replay(kShared, "60"), 0, {"4 interpolated"}, writer_);
  solver.signal(SIGTERM);  // a running solver would change its region when it sleeps
  EXPECT_EQ(solver.wait().code, 0);
  const std::vector<std::string> trusting{"--owner", "12345"};
  for (const std::vector<std::string>& verb : std::vector<std::vector<std::string>>{
           {"sample", "a", "--rate", "10", "--count", "2"}, {"info", "a"}}) {
    auto with_owner = verb;
    with_owner.insert(with_owner.end(), trusting.begin(), trusting.end());
    attack_without_effect(memory, with_owner, 0, {verb.front() == "info" ? "finished" : "settled"},
                          member_);
    attack_without_effect(memory, verb, 1, {"belongs to user 12345, who is not trusted (--owner)"},
                          member_);
    attack_without_effect(memory, with_owner, 1, {"splinecast.a.", "Permission denied"}, stranger_);
  }
  for (const Confinement& other : {member_, stranger_}) {
    attack_without_effect(memory, {"rm", "a", "--owner", "12345"}, 1, {"belongs to another user"},
                          other);
    attack_without_effect(memory, {"solve", "a", "--owner", "12345"}, 1,
                          {"belongs to another user"}, other);
    attack_without_effect(memory, {"doctor", "--clean"}, 0,
                          {"belongs to user 12345", "not changed"}, other);
  }
  auto into_the_group = shared({"replay", file_, "--stream", "b", "--embedded"});
  attack_without_effect(memory, into_the_group, 1, {"cannot give the region to group 54321"},
                        stranger_);
}

/// Takes each kind of lock on each file that it can open for writing or reading.
constexpr const char* kLocker = R"(
import fcntl, os, signal, struct, sys
held = []
for name in sorted(os.listdir('/dev/shm')):
    for mode in (os.O_RDWR, os.O_RDONLY):
        try: fd = os.open('/dev/shm/' + name, mode)
        except PermissionError: continue
        held.append(fd)
        for what in (lambda: fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB),
                     lambda: fcntl.lockf(fd, fcntl.LOCK_SH | fcntl.LOCK_NB),
                     lambda: fcntl.lockf(fd, fcntl.LOCK_EX | fcntl.LOCK_NB),
                     lambda: fcntl.fcntl(fd, 37, struct.pack('hhqqi4x', fcntl.F_RDLCK, 0, 0, 0, 0)),
                     lambda: fcntl.fcntl(fd, 37, struct.pack('hhqqi4x', fcntl.F_WRLCK, 0, 0, 0, 0))):
            try: what()
            except OSError: pass
def hold_again(*_):
    for fd in held:
        try: fcntl.fcntl(fd, 37, struct.pack('hhqqi4x', fcntl.F_RDLCK, 0, 0, 0, 0))
        except OSError: continue
        print('got one', file=sys.stderr, flush=True)
signal.signal(signal.SIGUSR1, hold_again)
print('locked', len(held), file=sys.stderr, flush=True)
while True: signal.pause()
)";

TEST_F(ForbiddenSharing, AReaderThatLocksEveryFileItCanPreventsNoTakeover) {
  REQUIRE_ROOT();
  const PrivateSharedMemory memory("64m");
  auto solver = std::make_unique<Process>(memory.start(shared({"solve", "a"}), writer_));
  solver->await_message("waiting for a producer");
  auto sending = shared(
      {"replay", file_, "--stream", "a", "--clock", "recorded", "--rate", "0.001", "--wait", "60"});
  Process producer = memory.start(sending, writer_);
  solver->await_message("solving");
  Process locker = memory.start("/usr/bin/python3", {"-c", kLocker}, member_);
  locker.await_message("locked 2");  // both regions, opened for reading; no lock file
  solver->signal(SIGKILL);
  solver->wait();
  // The kernel has released the dead owner's lock on the board. The reader now locks the board,
  // which blocks the same lock of the next owner.
  locker.signal(SIGUSR1);
  locker.await_message("got one");
  Process next = memory.start(shared({"solve", "a"}), writer_);
  next.await_message("taken over");
  attack(memory, {"info", "a", "--json"}, 0, {"\"state\": \"running\""}, writer_);
  producer.signal(SIGINT);  // finishes the stream, which needs a living solver
  judge(producer.wait(), "replay", 130, {"interrupted"});
  next.await_message("finished");
}

TEST_F(ForbiddenSharing, AForkedChildOfAnOwnerPreventsNoTakeover) {
  const TestStream stream;
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  const pid_t owner = fork();
  if (owner == 0) {
    Producer producer(stream.name(), {.dimensions = 1, .clock = StreamClock::recorded});
    Solver solver(stream.name(), {});
    if (!solver.attach()) _exit(1);
    const std::array<double, 1> one{1};
    if (producer.append({.time = Time(0), .position = one}) != AppendStatus::accepted) {
      _exit(1);
    }
    (void)solver.step(MonotonicClock());
    const pid_t child = fork();
    if (child != 0 && write(pipe_ends[1], &child, sizeof child) != sizeof child) _exit(1);
    for (;;) pause();
  }
  pid_t child = -1;
  ASSERT_EQ(read(pipe_ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  kill(owner, SIGKILL);
  waitpid(owner, nullptr, 0);
  for (const auto kind : {ipc::RegionKind::waypoints, ipc::RegionKind::spline}) {
    // The locks are free as soon as the child has run its fork handler.
    EXPECT_TRUE(testing::await([&] { return !ipc::is_owned(stream.name(), kind); }));
    EXPECT_TRUE(testing::await([&] { return !ipc::owner_lives(stream.name(), kind); }));
  }
  Process next({"solve", stream.name()});
  next.await_message("taken over");
  next.signal(SIGTERM);
  judge(next.wait(), "solve", 0, {"taken over"});
  Producer producer(stream.name(), {.dimensions = 1, .clock = StreamClock::recorded});
  EXPECT_TRUE(producer.continues());
  EXPECT_EQ(kill(child, 0), 0) << "the child has ended before the check";
  kill(child, SIGKILL);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

}  // namespace
}  // namespace splinecast::apps
