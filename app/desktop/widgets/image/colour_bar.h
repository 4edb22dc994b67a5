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
  void set_tone(const ToneSettings& tone, Dimension dimension);
  /// The texts beside the bar, from the lowest value up.
  const QStringList& labels() const { return labels_; }
  QSize sizeHint() const override;

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  ToneSettings tone_;
  QStringList labels_;
};

}  // namespace plenoflame::desktop
