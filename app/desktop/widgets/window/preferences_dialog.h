#pragma once
#include <QDialog>

class QCheckBox;
class QSettings;
class QSpinBox;

namespace plenoflame::desktop {

/// Settings that a user makes once, for all scenes.
struct Preferences {
  bool dark = false;
  int font_points = 0;  ///< size of all texts; 0: that of the system
  int threads = 0;      ///< for rendering; 0: one for each processor
};
Preferences preferences_of(const QSettings& settings);
void keep_preferences(const Preferences& preferences, QSettings& settings);

/// Theme, size of texts (large for a lecture), threads. Changes take effect at once; Cancel reverts
/// them.
class PreferencesDialog : public QDialog {
  Q_OBJECT
 public:
  explicit PreferencesDialog(const Preferences& preferences, QWidget* parent = nullptr);
  void reject() override;

 signals:
  void changed(const plenoflame::desktop::Preferences& preferences);

 private:
  void tell();
  Preferences before_;
  QCheckBox* dark_;
  QSpinBox *font_, *threads_;
};

}  // namespace plenoflame::desktop
