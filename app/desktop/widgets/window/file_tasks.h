#pragma once
#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <atomic>
#include <deque>
#include <functional>
#include <stop_token>

#include "model/jobs/latest_task.h"
#include "plenoflame/base/execution.h"

class QLabel;
class QPushButton;

namespace plenoflame::desktop {

/// Reads and writes files in the background, in the order of the requests. As a widget it shows the
/// present task and its time, and cancels it.
class FileTasks : public QWidget {
  Q_OBJECT
 public:
  explicit FileTasks(QWidget* parent = nullptr);
  ~FileTasks() override;

  /// @param what for the user: "export"  @param work on another thread; what it throws is said
  /// @param after on the window's thread, when work came to its end
  void add(const QString& what, std::function<void(const Execution&)> work,
           std::function<void()> after);
  /// True while something is being done or waits.
  bool busy() const { return !waiting_.empty(); }
  /// Stops the present one; waiting ones follow.
  void cancel();
  /// Stops all of them.
  void cancel_all();

 signals:
  void done(const QString& what);
  void cancelled(const QString& what);
  void failed(const QString& message);
  void warned(const QString& message);

 private:
  struct Task {
    QString what;
    std::function<void(const Execution&)> work;
    std::function<void()> after;
  };
  enum class End { done, cancelled, failed };
  void start();
  void finish(End end, const QString& message);
  void show_state();

  std::deque<Task> waiting_;  ///< the first one is being done
  std::stop_source stop_;
  std::atomic<double> fraction_{0};
  QElapsedTimer since_;
  QTimer clock_;
  QLabel* label_ = nullptr;
  QPushButton* cancel_ = nullptr;
  LatestTask thread_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
