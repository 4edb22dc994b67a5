#include "widgets/import_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"

namespace plenoflame::desktop {

ImportDialog::ImportDialog(const QString& folder, QWidget* parent) : QDialog(parent) {
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
  connect(browse, &QPushButton::clicked, this, [this, folder] {
    const QString name = QFileDialog::getOpenFileName(this, tr("Result of a simulation"), folder);
    if (!name.isEmpty()) file_->setText(name);
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
  layout->addWidget(message_);
  layout->addWidget(buttons);
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

cli::FlameImportRequest ImportDialog::request() const {
  cli::FlameImportRequest request;
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
