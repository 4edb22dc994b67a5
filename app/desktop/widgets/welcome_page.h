#pragma once
#include <QStringList>
#include <QWidget>

class QListWidget;

namespace plenoflame::desktop {

/// What one sees first: the paper's flame in one click, other examples, recent files.
class WelcomePage : public QWidget {
  Q_OBJECT
 public:
  explicit WelcomePage(QWidget* parent = nullptr);
  void set_recent(const QStringList& files);

 signals:
  void example_chosen(const QString& name);
  void file_chosen(const QString& path);
  void open_requested();

 private:
  QListWidget* recent_;
};

}  // namespace plenoflame::desktop
