#include "widgets/window/preferences_dialog.h"

#include <QApplication>
#include <QCheckBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QSettings>
#include <QSpinBox>

namespace plenoflame::desktop {
namespace {

constexpr int kSmallestFont = 7, kLargestFont = 28;  // [pt]
constexpr int kMostThreads = 1024;

}  // namespace

Preferences preferences_of(const QSettings& settings) {
  Preferences result;
  result.dark = settings.value("window/dark", false).toBool();
  result.font_points = settings.value("window/font", 0).toInt();
  if (result.font_points < kSmallestFont || result.font_points > kLargestFont)
    result.font_points = 0;
  result.threads = qBound(0, settings.value("render/threads", 0).toInt(), kMostThreads);
  return result;
}

void keep_preferences(const Preferences& preferences, QSettings& settings) {
  settings.setValue("window/dark", preferences.dark);
  settings.setValue("window/font", preferences.font_points);
  settings.setValue("render/threads", preferences.threads);
}

PreferencesDialog::PreferencesDialog(const Preferences& preferences, QWidget* parent)
    : QDialog(parent),
      before_(preferences),
      dark_(new QCheckBox(tr("Dark theme"), this)),
      font_(new QSpinBox(this)),
      threads_(new QSpinBox(this)) {
  setObjectName("preferences");
  setWindowTitle(tr("Preferences"));
  // The size that was there at first is what Cancel goes back to.
  if (before_.font_points == 0) before_.font_points = QApplication::font().pointSize();
  dark_->setObjectName("preferencesDark");
  dark_->setChecked(preferences.dark);
  font_->setObjectName("preferencesFont");
  font_->setRange(kSmallestFont, kLargestFont);
  font_->setSuffix(" pt");
  font_->setValue(before_.font_points);
  font_->setToolTip(tr("Size of all texts: 16 pt and more for a lecture"));
  threads_->setObjectName("preferencesThreads");
  threads_->setRange(0, kMostThreads);
  threads_->setSpecialValueText(tr("all processors"));
  threads_->setValue(preferences.threads);
  threads_->setToolTip(tr("Threads that render"));
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  auto* form = new QFormLayout(this);
  form->addRow(tr("Theme"), dark_);
  form->addRow(tr("Text"), font_);
  form->addRow(tr("Threads"), threads_);
  form->addRow(buttons);
  connect(dark_, &QCheckBox::toggled, this, &PreferencesDialog::tell);
  for (QSpinBox* box : {font_, threads_})
    connect(box, QOverload<int>::of(&QSpinBox::valueChanged), this, &PreferencesDialog::tell);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &PreferencesDialog::reject);
}

void PreferencesDialog::tell() {
  emit changed({dark_->isChecked(), font_->value(), threads_->value()});
}

void PreferencesDialog::reject() {
  emit changed(before_);
  QDialog::reject();
}

}  // namespace plenoflame::desktop
