#include "widgets/controls/file_chooser.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QSettings>

namespace plenoflame::desktop {

namespace {

constexpr const char* kFolder = "files/folder";

}  // namespace

QString FileChooser::file_to_read(QWidget* parent, const QString& title, const QString& filter) {
  const QString name = QFileDialog::getOpenFileName(parent, title, last_folder(), filter);
  if (!name.isEmpty()) keep_folder(QFileInfo(name).absolutePath());
  return name;
}

QString FileChooser::file_to_write(QWidget* parent, const QString& title, const QString& suggestion,
                                   const QString& filter) {
  const QString folder = last_folder();
  QString name = QFileDialog::getSaveFileName(
      parent, title, folder.isEmpty() ? suggestion : QDir(folder).filePath(suggestion), filter);
  if (name.isEmpty()) return name;
  if (QFileInfo(name).suffix().isEmpty()) name += "." + QFileInfo(suggestion).suffix();
  keep_folder(QFileInfo(name).absolutePath());
  return name;
}

QString FileChooser::folder(QWidget* parent, const QString& title) {
  const QString folder = QFileDialog::getExistingDirectory(parent, title, last_folder());
  if (!folder.isEmpty()) keep_folder(folder);
  return folder;
}

QString FileChooser::last_folder() const {
  return settings_->value(kFolder).toString();
}

void FileChooser::keep_folder(const QString& folder) {
  settings_->setValue(kFolder, folder);
}

}  // namespace plenoflame::desktop
