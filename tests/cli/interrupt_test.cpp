#include "interrupt.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "plenoflame/base/error.h"

namespace plenoflame::cli::interrupt_test {
namespace {

bool stops_soon(const InterruptHandler& handler) {
  for (int i = 0; i < 2000 && !handler.token().stop_requested(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return handler.interrupted();
}

TEST(Interrupt, FirstSignalRequestsAStop) {
  for (const int number : {SIGINT, SIGTERM}) {
    InterruptHandler handler;
    EXPECT_FALSE(handler.token().stop_requested());
    raise(number);
    EXPECT_TRUE(stops_soon(handler));
  }
}

TEST(Interrupt, RunsCallbacksOutsideOfTheSignalHandler) {
  InterruptHandler handler;
  const std::thread::id here = std::this_thread::get_id();
  std::thread::id there = here;
  {
    const std::stop_callback callback(handler.token(),
                                      [&there] { there = std::this_thread::get_id(); });
    raise(SIGINT);
    EXPECT_TRUE(stops_soon(handler));
  }
  EXPECT_NE(there, here);
}

TEST(Interrupt, RestoresWhatWasThere) {
  struct sigaction before {
  }, after{};
  sigaction(SIGINT, nullptr, &before);
  { const InterruptHandler handler; }
  sigaction(SIGINT, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

TEST(Interrupt, OnlyOneAtATime) {
  const InterruptHandler handler;
  EXPECT_THROW(InterruptHandler{}, Error);
}

TEST(InterruptDeathTest, SecondSignalEndsAtOnce) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto twice = [](int first, int second) {
    const InterruptHandler handler;
    raise(first);
    if (!stops_soon(handler)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    raise(second);
  };
  EXPECT_EXIT(twice(SIGINT, SIGINT), testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(twice(SIGINT, SIGTERM), testing::KilledBySignal(SIGTERM), "");
}

TEST(InterruptDeathTest, SignalsAreIgnoredOnceTheWorkIsDone) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto last_moment = [](bool done) {
    {
      InterruptHandler handler;
      if (done) handler.ignore_from_now();
    }
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) raise(number);
    std::exit(0);
  };
  EXPECT_EXIT(last_moment(true), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(last_moment(false), testing::KilledBySignal(SIGINT), "");
}

// As from timeout(1), which signals its child and then the group that the child is in.
TEST(Interrupt, SignalsThatComeTogetherAreOne) {
  InterruptHandler handler;
  raise(SIGTERM);
  EXPECT_TRUE(stops_soon(handler));
  raise(SIGINT);
  raise(SIGTERM);
  EXPECT_TRUE(handler.interrupted());
}

}  // namespace
}  // namespace plenoflame::cli::interrupt_test
