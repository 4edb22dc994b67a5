#pragma once
#include <QString>

class QSettings;
class QWidget;

namespace plenoflame::desktop {

/// Asks for files and folders. Each question begins in the folder of the last answer, in whatever
/// part of the window that was given; the user's settings keep it.
class FileChooser {
 public:
  /// @param settings are kept by the caller, and live longer
  explicit FileChooser(QSettings& settings) : settings_(&settings) {}
  /// All answers are empty where the question was cancelled.
  QString file_to_read(QWidget* parent, const QString& title, const QString& filter);
  /// @param suggestion name without a folder; a name that is typed without an ending has this one's
  QString file_to_write(QWidget* parent, const QString& title, const QString& suggestion,
                        const QString& filter);
  QString folder(QWidget* parent, const QString& title);

 private:
  QString last_folder() const;
  void keep_folder(const QString& folder);

  QSettings* settings_;
};

}  // namespace plenoflame::desktop
