#include "widgets/window/file_tasks.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame::desktop {
namespace {

constexpr int kShownAfter = 300;  ///< [ms] what is done sooner needs no button
constexpr int kInterval = 1000;   ///< [ms] between seconds that are shown

}  // namespace

FileTasks::FileTasks(QWidget* parent)
    : QWidget(parent), label_(new QLabel(this)), cancel_(new QPushButton(tr("Cancel"), this)) {
  label_->setObjectName("fileTaskLabel");
  cancel_->setObjectName("fileTaskCancel");
  cancel_->setToolTip(tr("Stop what is being read or written in the background"));
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(label_);
  layout->addWidget(cancel_);
  connect(cancel_, &QPushButton::clicked, this, &FileTasks::cancel);
  connect(&clock_, &QTimer::timeout, this, &FileTasks::show_state);
  hide();
}

FileTasks::~FileTasks() {
  cancel_all();
}

void FileTasks::add(const QString& what, std::function<void(const Execution&)> work,
                    std::function<void()> after) {
  waiting_.push_back({what, std::move(work), std::move(after)});
  if (waiting_.size() == 1) start();
}

void FileTasks::start() {
  stop_ = std::stop_source();
  fraction_ = 0;
  since_.start();
  clock_.start(kShownAfter);
  thread_.request([this, work = waiting_.front().work, what = waiting_.front().what,
                   token = stop_.get_token()](std::stop_token) {
    Execution execution;
    execution.stop = token;
    execution.message = [this](Severity severity, const std::string& text) {
      if (severity != Severity::warning) return;
      post(this, [this, text] { emit warned(QString::fromStdString(text)); });
    };
    execution.progress = [this](const Progress& progress) { fraction_ = progress.fraction; };
    End end = End::done;
    QString message;
    try {
      work(execution);
    } catch (const Cancelled&) {
      end = End::cancelled;
    } catch (const std::exception& error) {
      end = End::failed;
      message = QString::fromUtf8(error.what());
    } catch (...) {
      end = End::failed;
      message = tr("%1: unknown failure").arg(what);
    }
    post(this, [this, end, message] { finish(end, message); });
  });
}

void FileTasks::finish(End end, const QString& message) {
  const Task task = std::move(waiting_.front());
  waiting_.pop_front();
  clock_.stop();
  hide();
  if (!waiting_.empty()) start();
  if (end == End::failed) emit failed(message);
  if (end == End::cancelled) emit cancelled(task.what);
  if (end != End::done) return;
  emit done(task.what);
  task.after();
}

void FileTasks::show_state() {
  clock_.setInterval(kInterval);
  QString text = fraction_ > 0
                     ? tr("%1: %2 %").arg(waiting_.front().what).arg(100 * fraction_, 0, 'f', 0)
                     : tr("%1: %2 s").arg(waiting_.front().what).arg(since_.elapsed() / 1000);
  if (waiting_.size() > 1) text += tr(" (%1 more)").arg(waiting_.size() - 1);
  if (stop_.stop_requested()) text = tr("%1: being cancelled").arg(waiting_.front().what);
  label_->setText(text);
  show();
}

void FileTasks::cancel() {
  stop_.request_stop();
  if (busy()) show_state();
}

void FileTasks::cancel_all() {
  while (waiting_.size() > 1) waiting_.pop_back();
  stop_.request_stop();
}

}  // namespace plenoflame::desktop
