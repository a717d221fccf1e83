#include "touchdown/rig/driver/monitor.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <optional>

#include "tests/rig/driver/simulated_controller.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/driver/serial_driver.h"

namespace touchdown::rig {
namespace {

using core::literals::operator""_deg;
using core::literals::operator""_mm;

// What was told last.
class Told {
 public:
  void Tell(const RigState& state) {
    const std::lock_guard lock(mutex_);
    last_ = state;
    told_.notify_all();
  }
  bool Becomes(const RigState& wanted) {
    std::unique_lock lock(mutex_);
    return told_.wait_for(lock, std::chrono::seconds(20),
                          [&] { return last_ == wanted; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable told_;
  std::optional<RigState> last_;
};

// Real time: what is tested is that time passes.
class MonitorTest : public ::testing::Test {
 protected:
  SimulatedController controller_;
  SerialDriver driver_{controller_.port()};
  Told told_;
};

TEST_F(MonitorTest, TellsWhatTheControllerIs) {
  DriverMonitor monitor(driver_, [&](const auto& now) { told_.Tell(now); });
  EXPECT_TRUE(told_.Becomes({ArmedState::kNo, false}));
  controller_.LatchByHand();  // nobody asked for it
  EXPECT_TRUE(told_.Becomes({ArmedState::kYes, false}));
  controller_.PressButton();
  EXPECT_TRUE(told_.Becomes({ArmedState::kNo, true}));
}

TEST_F(MonitorTest, WhoNoLongerAnswersIsUnknown) {
  DriverMonitor monitor(driver_, [&](const auto& now) { told_.Tell(now); });
  EXPECT_TRUE(told_.Becomes({ArmedState::kNo, false}));
  controller_.Script("status", std::deque<Act>(1000, Act::kDeafness));
  EXPECT_TRUE(told_.Becomes({ArmedState::kUnknown, false}));
  controller_.Script("status", {});
  EXPECT_TRUE(told_.Becomes({ArmedState::kNo, false}));
}

TEST_F(MonitorTest, ItIsTheHeartbeat) {
  controller_.Watch();
  {
    DriverMonitor monitor(driver_, [&](const auto& now) { told_.Tell(now); });
    ASSERT_TRUE(driver_.Set({30.25_mm, -12.5_deg, 300.0_mm}));
    ASSERT_TRUE(driver_.Arm());
    // As many questions as take longer than the longest silence.
    const auto before = controller_.HowOften("status");
    EXPECT_TRUE(controller_.Hears("status", before + 12));
    EXPECT_TRUE(controller_.armed());
    EXPECT_EQ(controller_.silences(), 0);
  }
  // The program is there, and hangs.
  EXPECT_TRUE(controller_.BecomesDisarmed());
  EXPECT_EQ(controller_.silences(), 1);
  EXPECT_EQ(controller_.stop_bytes(), 0);
}

}  // namespace
}  // namespace touchdown::rig
