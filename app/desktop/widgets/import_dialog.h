#pragma once
#include <QDialog>

#include "vtk_commands.h"

class QComboBox;
class QLabel;
class QLineEdit;

namespace plenoflame::desktop {

/// Asks which file of a simulation becomes a flame, and what its arrays mean.
class ImportDialog : public QDialog {
  Q_OBJECT
 public:
  explicit ImportDialog(const QString& folder, QWidget* parent = nullptr);
  /// @throws InputError naming the field that is wrong
  cli::FlameImportRequest request() const;
  /// Stays open, with the message, while a field is wrong.
  void accept() override;

 private:
  QLineEdit *file_, *temperature_, *source_, *wavelength_, *voxel_size_;
  QComboBox *temperature_unit_, *kind_;
  QLabel* message_;
};

}  // namespace plenoflame::desktop
