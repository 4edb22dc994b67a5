#pragma once
#include <QDialog>

#include "model/jobs/latest_task.h"
#include "vtk_commands.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QTableWidget;
class QLineEdit;

namespace plenoflame::desktop {

class FileChooser;

/// Asks which file of a simulation becomes a flame, and what its arrays mean.
class ImportDialog : public QDialog {
  Q_OBJECT
 public:
  explicit ImportDialog(FileChooser& chooser, QWidget* parent = nullptr);
  /// @throws InputError naming the field that is wrong
  FlameImportRequest request() const;
  /// Stays open, with the message, while a field is wrong.
  void accept() override;
  ~ImportDialog() override;

 private:
  void list_arrays();
  void show_arrays(const std::vector<SimulationArray>& arrays, const QString& wrong);
  void take_array(int row);

  QLineEdit *file_, *temperature_, *source_, *wavelength_, *voxel_size_;
  QComboBox *temperature_unit_, *kind_;
  QLabel *message_, *arrays_label_;
  QTableWidget* arrays_;
  QString listed_;                        ///< file whose arrays are on display, or being read
  QLineEdit* filled_;                     ///< takes the array that is double-clicked
  LatestTask task_{Urgency::waited_for};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
