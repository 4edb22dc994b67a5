#pragma once
#include <QDialog>
#include <map>
#include <string>

#include "plenoflame/scene/flame_spec.h"
#include "plenoflame/volumes/vdb_info.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QLineEdit;

namespace plenoflame::desktop {

/// Asks for a generated flame and its parameters.
class GenerateDialog : public QDialog {
  Q_OBJECT
 public:
  explicit GenerateDialog(QWidget* parent = nullptr);
  std::string name() const;
  std::map<std::string, std::string> values() const;
  void show_error(const QString& message);

 private:
  void fill();
  QComboBox* kind_;
  QWidget* fields_;
  QFormLayout* form_;
  QLabel* message_;
  std::map<std::string, QLineEdit*> edits_;
};

/// Asks which grids of a file are temperature and absorption, and in which units. It starts from a
/// guess and says what is doubtful about it.
class MappingDialog : public QDialog {
  Q_OBJECT
 public:
  MappingDialog(const FlameSpec& flame, const VdbInfo& info, QWidget* parent = nullptr);
  /// The flame with what was chosen.
  FlameSpec flame() const;

 private:
  struct Row {
    QComboBox *grid, *unit;
    QDoubleSpinBox *scale, *offset;
    QLabel* about;
  };
  Row add_row(QFormLayout& form, const QString& title, const GridSpec& spec,
              const std::string& guess, const QStringList& units);
  GridSpec spec_of(const Row& row) const;
  void describe(const Row& row);

  FlameSpec flame_;
  VdbInfo info_;
  Row temperature_, absorption_;
};

}  // namespace plenoflame::desktop
