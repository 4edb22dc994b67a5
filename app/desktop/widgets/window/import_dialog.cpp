#include "widgets/window/import_dialog.h"

#include <QApplication>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "widgets/controls/file_chooser.h"

namespace plenoflame::desktop {
namespace {

constexpr int kLineLength = 80;  ///< [characters] for paths, and for arrays' names and ranges

}  // namespace

ImportDialog::ImportDialog(FileChooser& chooser, QWidget* parent) : QDialog(parent) {
  setMinimumWidth(kLineLength * fontMetrics().averageCharWidth());
  setWindowTitle(tr("Import a flame"));
  setObjectName("importDialog");
  const auto edit = [this](const char* name, const QString& text, const QString& tip) {
    auto* line = new QLineEdit(text, this);
    line->setObjectName(name);
    line->setToolTip(tip);
    return line;
  };
  file_ = edit("importFile", {},
               tr("Result of a simulation: VTK (.vtu, .vti, .vtk, ...), OpenFOAM (.foam), EnSight, "
                  "CGNS, ..."));
  auto* browse = new QPushButton(tr("Browse..."), this);
  connect(browse, &QPushButton::clicked, this, [this, &chooser] {
    const QString name = chooser.file_to_read(this, tr("Result of a simulation"), {});
    if (name.isEmpty()) return;
    file_->setText(name);
    list_arrays();
  });
  temperature_ = edit("importTemperature", "T", tr("Name of the array of temperatures"));
  temperature_unit_ = new QComboBox(this);
  temperature_unit_->addItems({"K", "degC"});
  kind_ = new QComboBox(this);
  kind_->addItems({tr("Array of absorption [1/m]"), tr("Array of soot volume fractions"),
                   tr("The same everywhere")});
  kind_->setToolTip(tr("Where the absorption comes from"));
  source_ = edit("importSource", {},
                 tr("Name of that array; or the absorption with its unit, e.g. 20 1/m"));
  wavelength_ = edit("importWavelength", "650 nm",
                     tr("With soot: wavelength at which its absorption is wanted"));
  voxel_size_ = edit("importVoxelSize", {},
                     tr("Spacing of the grids, e.g. 0.5 mm; empty: as fine as the simulation"));
  auto* row = new QHBoxLayout;
  row->addWidget(file_, 1);
  row->addWidget(browse);
  auto* second = new QHBoxLayout;
  second->addWidget(temperature_, 1);
  second->addWidget(temperature_unit_);
  auto* form = new QFormLayout;
  form->addRow(tr("File"), row);
  form->addRow(tr("Temperature"), second);
  form->addRow(tr("Absorption"), kind_);
  form->addRow(tr("Array or value"), source_);
  form->addRow(tr("Wavelength"), wavelength_);
  form->addRow(tr("Voxel size"), voxel_size_);
  kind_->setObjectName("importKind");
  arrays_label_ = new QLabel(tr("The arrays of the file are listed here once it is chosen."), this);
  arrays_label_->setObjectName("importArraysLabel");
  arrays_label_->setWordWrap(true);
  arrays_ = new QTableWidget(0, 3, this);
  arrays_->setObjectName("importArrays");
  arrays_->setHorizontalHeaderLabels({tr("Array"), tr("Lowest"), tr("Highest")});
  arrays_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  arrays_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
  arrays_->verticalHeader()->hide();
  arrays_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  arrays_->setSelectionBehavior(QAbstractItemView::SelectRows);
  arrays_->setToolTip(tr(
      "Double click: this array is the temperature, or that of the absorption when its field was "
      "the last to be in use"));
  filled_ = temperature_;
  connect(arrays_, &QTableWidget::cellDoubleClicked, this, &ImportDialog::take_array);
  connect(file_, &QLineEdit::editingFinished, this, &ImportDialog::list_arrays);
  connect(qApp, &QApplication::focusChanged, this, [this](QWidget*, QWidget* now) {
    if (now == temperature_ || now == source_) filled_ = static_cast<QLineEdit*>(now);
  });
  message_ = new QLabel(this);
  message_->setObjectName("importMessage");
  message_->setWordWrap(true);
  message_->setMargin(4);
  message_->setStyleSheet("background: #b3261e; color: white;");
  message_->hide();
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  connect(buttons, &QDialogButtonBox::accepted, this, &ImportDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* layout = new QVBoxLayout(this);
  layout->addLayout(form);
  layout->addWidget(arrays_label_);
  layout->addWidget(arrays_, 1);
  layout->addWidget(message_);
  layout->addWidget(buttons);
}

ImportDialog::~ImportDialog() = default;

void ImportDialog::list_arrays() {
  const QString file = file_->text().trimmed();
  if (file == listed_) return;
  listed_ = file;
  arrays_->setRowCount(0);
  task_.cancel();
  if (file.isEmpty()) return;
  arrays_label_->setText(tr("The file is being read..."));
  task_.request([this, file](const std::stop_token& stop) {
    Execution execution;
    execution.stop = stop;
    std::vector<SimulationArray> arrays;
    QString wrong;
    try {
      arrays = list_simulation_arrays(file.toStdString(), execution);
    } catch (const std::exception& error) {
      wrong = QString::fromUtf8(error.what());
    }
    post(this, [this, file, arrays, wrong] {
      if (file == listed_) show_arrays(arrays, wrong);
    });
  });
}

void ImportDialog::show_arrays(const std::vector<SimulationArray>& arrays, const QString& wrong) {
  arrays_label_->setText(!wrong.isEmpty() ? wrong
                         : arrays.empty() ? tr("The file has no arrays of single numbers.")
                                          : tr("Arrays of the file, as it has them:"));
  arrays_->setRowCount(static_cast<int>(arrays.size()));
  for (int row = 0; row < arrays_->rowCount(); ++row) {
    const SimulationArray& array = arrays[static_cast<std::size_t>(row)];
    const QStringList texts{QString::fromStdString(array.name),
                            QString::number(array.lowest, 'g', 5),
                            QString::number(array.highest, 'g', 5)};
    for (int k = 0; k < texts.size(); ++k) arrays_->setItem(row, k, new QTableWidgetItem(texts[k]));
  }
}

void ImportDialog::take_array(int row) {
  filled_->setText(arrays_->item(row, 0)->text());
}

void ImportDialog::accept() {
  try {
    request();
  } catch (const Error& error) {
    message_->setText(QString::fromUtf8(error.what()));
    message_->show();
    return;
  }
  QDialog::accept();
}

FlameImportRequest ImportDialog::request() const {
  FlameImportRequest request;
  if (file_->text().trimmed().isEmpty()) throw InputError("choose a file to import");
  request.files = {file_->text().trimmed().toStdString()};
  request.temperature = temperature_->text().trimmed().toStdString();
  request.temperature_unit = temperature_unit_->currentText().toStdString();
  const std::string source = source_->text().trimmed().toStdString();
  if (source.empty())
    throw InputError("say where the absorption comes from: the name of an array, or a value");
  if (kind_->currentIndex() == 0) request.absorption = source;
  if (kind_->currentIndex() == 1) request.soot = source;
  if (kind_->currentIndex() == 2) request.constant = parse_quantity(source, Dimension::absorption);
  request.wavelength = parse_quantity(wavelength_->text().toStdString(), Dimension::length);
  if (!voxel_size_->text().trimmed().isEmpty())
    request.voxel_size =
        parse_quantity(voxel_size_->text().trimmed().toStdString(), Dimension::length);
  request.step = 0;
  return request;
}

}  // namespace plenoflame::desktop
