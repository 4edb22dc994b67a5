#pragma once
#include <QWidget>

#include "model/image_display.h"
#include "plenoflame/base/units.h"

namespace plenoflame::desktop {

/// The colours of a picture with the values that they stand for, beside it.
class ColourBar : public QWidget {
  Q_OBJECT
 public:
  explicit ColourBar(QWidget* parent = nullptr);
  /// @param unit of values without a dimension, as "e-"; may be empty
  void set_tone(const ToneSettings& tone, Dimension dimension, const QString& unit = {});
  /// The texts beside the bar, from the lowest value up.
  const QStringList& labels() const { return labels_; }
  /// As wide as its widest numbers so far: widgets beside it do not move with them.
  QSize sizeHint() const override;

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  ToneSettings tone_;
  QStringList labels_;
  QString widest_ = "000 nW";  ///< of all labels so far
};

}  // namespace plenoflame::desktop
