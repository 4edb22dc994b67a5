#pragma once
#include <QDialog>
#include <QStringList>
#include <QTextBrowser>

class QAction;

namespace plenoflame::desktop {

/// A page of the documentation as text that can be read: notes for programs in it are left out.
class HelpBrowser : public QTextBrowser {
  Q_OBJECT
 public:
  using QTextBrowser::QTextBrowser;
  QVariant loadResource(int type, const QUrl& name) override;
};

/// The documentation, beside the window: pages link to each other, Backspace or "Back" goes back.
class HelpWindow : public QDialog {
  Q_OBJECT
 public:
  explicit HelpWindow(QWidget* parent = nullptr);
  /// @param path of a Markdown file
  void show_page(const QString& path);
  QString page() const;

 private:
  HelpBrowser* browser_;
};

}  // namespace plenoflame::desktop
