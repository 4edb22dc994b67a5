#pragma once
#include <QScrollArea>
#include <QStringList>
#include <vector>

class QAction;
class QVBoxLayout;

namespace plenoflame::desktop {

/// Groups one below the other. The title of each opens and closes it; those that are open share the
/// height, and scroll where it is too little for them.
class SidePanel : public QScrollArea {
  Q_OBJECT
 public:
  explicit SidePanel(QWidget* parent = nullptr);
  /// Adds a group, which is closed. @param name of the widget that holds title and content
  void add(const char* name, const QString& title, QWidget* content);
  /// Opens a group and brings it into view. False: there is none of this name or title.
  bool open(const QString& name);
  /// Open and close one group each, and are checked while it is open. Their texts are the titles.
  std::vector<QAction*> groups() const;
  /// Names of those that are open.
  QStringList opened() const;
  /// Opens these and closes all others.
  void set_opened(const QStringList& names);
  QSize minimumSizeHint() const override { return {160, 120}; }

 private:
  struct Group {
    QWidget *whole, *head, *content;
    QAction* action;
  };
  /// Scrolls to a group: to its head if not all of it has room.
  void show_group(QWidget& whole, QWidget& head);

  std::vector<Group> groups_;
  QVBoxLayout* column_;
};

}  // namespace plenoflame::desktop
