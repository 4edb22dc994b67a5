#pragma once
#include <QStringList>
#include <QWidget>

class QListWidget;
class QPushButton;

namespace plenoflame::desktop {

/// The first page: the paper's flame in one click, other examples, recent files.
class WelcomePage : public QWidget {
  Q_OBJECT
 public:
  explicit WelcomePage(QWidget* parent = nullptr);
  void set_recent(const QStringList& files);
  /// Tells that a scene is open behind this page.
  void set_open(bool open);

 signals:
  void example_chosen(const QString& name);
  void file_chosen(const QString& path);
  void open_requested();
  void back_requested();

 private:
  QListWidget* recent_;
  QPushButton* back_;
};

}  // namespace plenoflame::desktop
