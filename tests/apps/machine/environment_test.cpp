#include "apps/machine/environment.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

/// A machine that consists of files in a test folder.
class FakeMachine {
 public:
  void say(const std::string& file, const std::string& text) const {
    const std::filesystem::path path = folder_.path(file);
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text << '\n';
  }
  [[nodiscard]] Environment read() const { return read_environment(folder_.path("")); }

 private:
  testing::TestFolder folder_;
};

TEST(Environment, ReadsTheFactsThatAMachineReports) {
  const FakeMachine machine;
  machine.say("proc/cpuinfo",
              "processor\t: 0\nmodel name\t: A CPU @ 2.50GHz\nflags\t\t: fpu hypervisor sse\n\n"
              "processor\t: 1\nmodel name\t: Another CPU");
  machine.say("proc/sys/kernel/osrelease", "6.1.0-rt");
  machine.say("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.0");
  machine.say("proc/sys/kernel/sched_rt_runtime_us", "950000");
  machine.say("proc/sys/kernel/sched_rt_period_us", "1000000");
  machine.say("sys/class/dmi/id/sys_vendor", "Maker");
  machine.say("sys/class/dmi/id/product_name", "Cloud");
  machine.say("sys/devices/system/cpu/online", "0-3");
  machine.say("sys/devices/system/cpu/isolated", "2-3");
  machine.say("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  machine.say("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  machine.say("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "performance");
  machine.say("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc");
  const Environment found = machine.read();
  EXPECT_FALSE(found.version.empty());
  EXPECT_EQ(found.cpu, "A CPU @ 2.50GHz");
  EXPECT_EQ(found.online, "0-3");
  EXPECT_EQ(found.isolated, "2-3");
  EXPECT_EQ(found.governor, "performance,powersave");
  EXPECT_EQ(found.kernel, "6.1.0-rt");
  EXPECT_EQ(found.preemption, "PREEMPT_DYNAMIC");
  EXPECT_EQ(found.hypervisor, "Maker Cloud");
  EXPECT_EQ(found.clock, "tsc");
  EXPECT_EQ(found.rt_runtime, "950000");
  EXPECT_EQ(found.rt_period, "1000000");
  EXPECT_EQ(to_json(found).at("governor"), "performance,powersave");
}

TEST(Environment, LeavesMissingFactsEmpty) {
  const Environment found = FakeMachine().read();
  EXPECT_FALSE(found.version.empty());
  for (const std::string& text :
       {found.cpu, found.online, found.isolated, found.governor, found.kernel, found.preemption,
        found.hypervisor, found.clock, found.rt_runtime, found.rt_period}) {
    EXPECT_EQ(text, "");
  }
}

TEST(Environment, KnowsWhetherRealTimeProcessesAreThrottled) {
  Environment environment;
  EXPECT_FALSE(throttled_time(environment));
  environment.rt_period = "1000000";
  EXPECT_FALSE(throttled_time(environment));
  environment.rt_runtime = "950000";
  EXPECT_EQ(throttled_time(environment), std::chrono::milliseconds(50));
  environment.rt_runtime = "1000000";
  EXPECT_EQ(throttled_time(environment), Time::zero());
  environment.rt_runtime = "-1";
  EXPECT_EQ(throttled_time(environment), Time::zero());
}

TEST(Environment, DistinguishesBareMetalFromVirtualAndPreemptionFromNone) {
  const FakeMachine machine;
  machine.say("proc/cpuinfo", "flags : fpu sse");
  machine.say("sys/class/dmi/id/sys_vendor", "Maker");
  machine.say("proc/sys/kernel/version", "#1 SMP Debian");
  EXPECT_EQ(machine.read().hypervisor, "");
  EXPECT_EQ(machine.read().preemption, "none");
  machine.say("sys/hypervisor/type", "xen");
  EXPECT_EQ(machine.read().hypervisor, "xen");
  machine.say("sys/kernel/realtime", "1");
  EXPECT_EQ(machine.read().preemption, "PREEMPT_RT");
}

TEST(Environment, AHypervisorThatHidesItsNameIsUnknown) {
  const FakeMachine machine;
  machine.say("proc/cpuinfo", "flags : fpu hypervisor");
  EXPECT_EQ(machine.read().hypervisor, "unknown");
}

TEST(Environment, ReadsTheKernelAndTheCpusOfThisMachine) {
  const Environment found = read_environment();
  EXPECT_FALSE(found.kernel.empty());
  EXPECT_FALSE(found.online.empty());
}

}  // namespace
}  // namespace splinecast::apps
