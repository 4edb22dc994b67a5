#include "widgets/window/help_window.h"

#include <QFile>
#include <QHBoxLayout>
#include <QPushButton>
#include <QRegularExpression>
#include <QVBoxLayout>

namespace plenoflame::desktop {

QVariant HelpBrowser::loadResource(int type, const QUrl& name) {
  if (!name.isLocalFile() || !name.path().endsWith(".md"))
    return QTextBrowser::loadResource(type, name);
  QFile file(name.toLocalFile());
  if (!file.open(QIODevice::ReadOnly)) return tr("This page is not installed.");
  QString text = QString::fromUtf8(file.readAll());
  // Marks for the tests of the documentation.
  static const QRegularExpression note("<!--.*?-->",
                                       QRegularExpression::DotMatchesEverythingOption);
  return text.remove(note);
}

HelpWindow::HelpWindow(QWidget* parent) : QDialog(parent), browser_(new HelpBrowser(this)) {
  setObjectName("helpWindow");
  setWindowTitle(tr("Plenoflame: documentation"));
  browser_->setObjectName("helpBrowser");
  browser_->setOpenExternalLinks(true);
  auto* back = new QPushButton(tr("Back"), this);
  auto* forward = new QPushButton(tr("Forward"), this);
  back->setObjectName("helpBack");
  back->setToolTip(tr("The page before (Alt+Left)"));
  forward->setToolTip(tr("The page after (Alt+Right)"));
  for (QPushButton* button : {back, forward}) {
    button->setAutoDefault(false);
    button->setEnabled(false);
  }
  connect(back, &QPushButton::clicked, browser_, &QTextBrowser::backward);
  connect(forward, &QPushButton::clicked, browser_, &QTextBrowser::forward);
  connect(browser_, &QTextBrowser::backwardAvailable, back, &QWidget::setEnabled);
  connect(browser_, &QTextBrowser::forwardAvailable, forward, &QWidget::setEnabled);
  auto* buttons = new QHBoxLayout;
  buttons->addWidget(back);
  buttons->addWidget(forward);
  buttons->addStretch(1);
  auto* layout = new QVBoxLayout(this);
  layout->addLayout(buttons);
  layout->addWidget(browser_, 1);
  resize(760, 720);
}

void HelpWindow::show_page(const QString& path) {
  browser_->setSource(QUrl::fromLocalFile(path));
  show();
  raise();
  activateWindow();
}

QString HelpWindow::page() const {
  return browser_->source().fileName();
}

}  // namespace plenoflame::desktop
