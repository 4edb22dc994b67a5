#include "widgets/flame/flame_dialogs.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "plenoflame/volumes/flame_generators.h"

namespace plenoflame::desktop {

GenerateDialog::GenerateDialog(QWidget* parent)
    : QDialog(parent),
      kind_(new QComboBox(this)),
      fields_(nullptr),
      form_(nullptr),
      message_(new QLabel(this)) {
  setWindowTitle(tr("Generate a flame"));
  setObjectName("generateDialog");
  kind_->setObjectName("generatorKind");
  for (const FlameGenerator& generator : flame_generators()) {
    const std::string name(generator.name);
    kind_->addItem(QString::fromStdString(name));
  }
  message_->setWordWrap(true);
  message_->setStyleSheet("background: #b3261e; color: white;");
  message_->setMargin(4);
  message_->hide();
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  buttons->button(QDialogButtonBox::Ok)->setText(tr("Generate and save..."));
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(kind_);
  layout->addWidget(message_);
  layout->addWidget(buttons);
  connect(kind_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &GenerateDialog::fill);
  fill();
}

void GenerateDialog::fill() {
  delete fields_;
  edits_.clear();
  fields_ = new QWidget(this);
  form_ = new QFormLayout(fields_);
  for (const FlameParameter& parameter : flame_generator(name()).parameters()) {
    auto* edit = new QLineEdit(QString::fromStdString(parameter.value), fields_);
    const QString label = QString::fromStdString(parameter.name).replace('_', ' ');
    const QString about = QString::fromStdString(parameter.about);
    edit->setToolTip(about);
    edit->setPlaceholderText(about);  // where there is no default that says it
    if (parameter.value.empty())
      edit->setMinimumWidth(edit->fontMetrics().horizontalAdvance(about));
    edit->setObjectName("field-" + label);
    form_->addRow(label, edit);
    edits_[parameter.name] = edit;
  }
  static_cast<QVBoxLayout*>(layout())->insertWidget(1, fields_);
}

std::string GenerateDialog::name() const {
  return kind_->currentText().toStdString();
}

std::map<std::string, std::string> GenerateDialog::values() const {
  std::map<std::string, std::string> values;
  for (const auto& [name, edit] : edits_) values[name] = edit->text().toStdString();
  return values;
}

void GenerateDialog::show_error(const QString& message) {
  message_->setText(message);
  message_->show();
}

MappingDialog::MappingDialog(const FlameSpec& flame, const VdbInfo& info, QWidget* parent)
    : QDialog(parent), flame_(flame), info_(info) {
  setWindowTitle(tr("Grids of %1").arg(QString::fromStdString(info.file)));
  setObjectName("mappingDialog");
  auto* form = new QFormLayout;
  temperature_ =
      add_row(*form, tr("Temperature"), flame.temperature, info.temperature_grid, {"K", "degC"});
  absorption_ = add_row(*form, tr("Absorption"), flame.absorption, info.absorption_grid,
                        {"1/m", "1/cm", "1/mm"});
  QString remarks;
  for (const std::string& remark : info.remarks) remarks += QString::fromStdString(remark) + "\n";
  auto* warning = new QLabel(remarks.trimmed(), this);
  warning->setObjectName("mappingWarning");
  warning->setWordWrap(true);
  warning->setMargin(4);
  warning->setStyleSheet("background: #e69f00; color: black;");
  warning->setVisible(!remarks.isEmpty());
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* layout = new QVBoxLayout(this);
  layout->addLayout(form);
  layout->addWidget(warning);
  layout->addWidget(buttons);
}

MappingDialog::Row MappingDialog::add_row(QFormLayout& form, const QString& title,
                                          const GridSpec& spec, const std::string& guess,
                                          const QStringList& units) {
  Row row{new QComboBox(this), new QComboBox(this), new QDoubleSpinBox(this),
          new QDoubleSpinBox(this), new QLabel(this)};
  row.grid->setObjectName(title + "Grid");
  row.grid->addItem(
      guess.empty() ? tr("(none found)") : tr("guess: %1").arg(QString::fromStdString(guess)),
      QString());
  for (const GridInfo& grid : info_.grids)
    if (grid.readable)
      row.grid->addItem(QString::fromStdString(grid.name), QString::fromStdString(grid.name));
  const int index = row.grid->findData(QString::fromStdString(spec.grid));
  row.grid->setCurrentIndex(std::max(0, index));
  row.unit->addItem(tr("as the file says"), QString());
  for (const QString& unit : units) row.unit->addItem(unit, unit);
  row.unit->setCurrentIndex(std::max(0, row.unit->findData(QString::fromStdString(spec.unit))));
  for (QDoubleSpinBox* box : {row.scale, row.offset}) {
    box->setDecimals(6);
    box->setRange(-1e9, 1e9);
  }
  row.scale->setValue(spec.scale);
  row.offset->setValue(spec.offset);
  row.scale->setPrefix("x ");
  row.offset->setPrefix("+ ");
  row.scale->setToolTip(tr("Stored values are multiplied by this"));
  row.offset->setToolTip(tr("Then this is added, in the unit chosen"));
  auto* line = new QHBoxLayout;
  // The same widths in both rows, so that they are columns.
  for (QWidget* part : std::initializer_list<QWidget*>{row.grid, row.scale, row.offset, row.unit})
    line->addWidget(part, 1);
  form.addRow(title, line);
  form.addRow(QString(), row.about);
  connect(row.grid, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
          [this, row] { describe(row); });
  describe(row);
  return row;
}

void MappingDialog::describe(const Row& row) {
  std::string name = row.grid->currentData().toString().toStdString();
  if (name.empty())
    name = row.grid->objectName().startsWith(tr("Temperature")) ? info_.temperature_grid
                                                                : info_.absorption_grid;
  row.about->setText({});
  for (const GridInfo& grid : info_.grids)
    if (grid.name == name)
      row.about->setText(
          tr("%1 to %2 %3, %4 voxels")
              .arg(grid.minimum, 0, 'g', 4)
              .arg(grid.maximum, 0, 'g', 4)
              .arg(grid.unit.empty() ? tr("(no unit stated)") : QString::fromStdString(grid.unit))
              .arg(grid.active_voxels));
}

GridSpec MappingDialog::spec_of(const Row& row) const {
  GridSpec spec;
  spec.grid = row.grid->currentData().toString().toStdString();
  spec.unit = row.unit->currentData().toString().toStdString();
  spec.scale = row.scale->value();
  spec.offset = row.offset->value();
  return spec;
}

FlameSpec MappingDialog::flame() const {
  FlameSpec flame = flame_;
  flame.temperature = spec_of(temperature_);
  flame.absorption = spec_of(absorption_);
  return flame;
}

}  // namespace plenoflame::desktop
