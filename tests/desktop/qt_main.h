#pragma once
#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <functional>

namespace plenoflame::desktop::test {

/// Lets events happen until the condition holds; false when it does not within the time.
inline bool wait_for(const std::function<bool()>& condition, int milliseconds = 300000) {
  QElapsedTimer since;
  since.start();
  while (!condition()) {
    if (since.elapsed() > milliseconds) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, 20);
  }
  return true;
}

}  // namespace plenoflame::desktop::test
