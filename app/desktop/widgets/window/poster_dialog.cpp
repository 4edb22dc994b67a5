#include "widgets/window/poster_dialog.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QPainter>
#include <QSpinBox>
#include <algorithm>

#include "picture_camera.h"
#include "plenoflame/base/units.h"
#include "widgets/image/image_panel.h"
#include "widgets/scene/scene_view.h"

namespace plenoflame::desktop {
namespace {

constexpr int kLargest = 8192;
constexpr QSize kUsual{3840, 2160};
constexpr double kBarShare = 0.2;   ///< of the width: the longest scale bar
constexpr double kLetters = 0.025;  ///< height of letters, of the picture's

/// A bar of a round length in the lower left corner. Its ground is the poster's, as light fields
/// are black on every poster. @param metres of a pixel
void draw_scale_bar(QImage& picture, double metres, const QColor& ground) {
  if (!(metres > 0)) return;
  const QColor ink = ground.lightness() < 128 ? QColor(225, 227, 230) : QColor(40, 42, 46);
  const double length = views::round_length(kBarShare * picture.width() * metres);
  const double letters = kLetters * picture.height();
  QPainter painter(&picture);
  painter.setRenderHint(QPainter::Antialiasing);
  QFont font = painter.font();
  font.setPixelSize(std::max(1, static_cast<int>(letters)));
  painter.setFont(font);
  painter.setPen(QPen(ink, 0.15 * letters));
  const QPointF begin(2 * letters, picture.height() - 2 * letters),
      end = begin + QPointF(length / metres, 0);
  const QRectF place(begin.x(), begin.y() - 2 * letters, end.x() - begin.x(), 1.6 * letters);
  constexpr int kPlaced = Qt::AlignHCenter | Qt::AlignBottom | Qt::TextDontClip;
  const QString text = QString::fromStdString(readable_quantity(length, Dimension::length));
  const double margin = 0.5 * letters;
  painter.fillRect(painter.boundingRect(place, kPlaced, text)
                       .united(QRectF(begin, end))
                       .adjusted(-margin, -margin, margin, margin),
                   ground);
  painter.drawLine(begin, end);
  painter.drawText(place, kPlaced, text);
}

}  // namespace

PosterDialog::PosterDialog(QWidget* parent)
    : QDialog(parent),
      of_(new QComboBox(this)),
      background_(new QComboBox(this)),
      width_(new QSpinBox(this)),
      height_(new QSpinBox(this)),
      scale_bar_(new QCheckBox(tr("Scale bar"), this)) {
  setObjectName("posterDialog");
  setWindowTitle(tr("Export a picture"));
  of_->setObjectName("posterOf");
  of_->addItems({tr("The scene in 3-D"), tr("The light field"),
                 tr("What the eye sees beside what the camera sees")});
  background_->setObjectName("posterBackground");
  for (const auto& [name, colour] : {std::pair{tr("Dark"), QColor(13, 14, 17)},
                                     {tr("Black"), QColor(Qt::black)},
                                     {tr("White"), QColor(Qt::white)}})
    background_->addItem(name, colour);
  width_->setObjectName("posterWidth");
  height_->setObjectName("posterHeight");
  for (const auto& [box, value] : {std::pair{width_, kUsual.width()}, {height_, kUsual.height()}}) {
    box->setRange(64, kLargest);
    box->setSuffix(tr(" pixels"));
    box->setValue(value);
  }
  scale_bar_->setObjectName("posterScaleBar");
  scale_bar_->setChecked(true);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* form = new QFormLayout(this);
  form->addRow(tr("Picture"), of_);
  form->addRow(tr("Width"), width_);
  form->addRow(tr("Height"), height_);
  form->addRow(tr("Background"), background_);
  form->addRow(scale_bar_);
  form->addRow(buttons);
}

Poster PosterDialog::poster() const {
  return {static_cast<Poster::Of>(of_->currentIndex()),
          {width_->value(), height_->value()},
          background_->currentData().value<QColor>(),
          scale_bar_->isChecked()};
}

QImage make_poster(const Poster& poster, SceneView& scene, const ImagePanel& image) {
  const bool both = poster.of == Poster::Of::both;
  const QSize each(both ? poster.size.width() / 2 : poster.size.width(), poster.size.height());
  QImage picture(poster.size, QImage::Format_RGB32);
  picture.fill(poster.background);
  QPainter painter(&picture);
  if (poster.of != Poster::Of::light_field) {
    const FlameLook look = scene.flame_look();
    FlameLook seen = look;
    seen.drawing = FlameDrawing::eye;
    if (both) scene.set_flame_look(seen);
    double metres = 0;
    QImage part = scene.poster(each, poster.background, metres);
    if (both) scene.set_flame_look(look);
    if (poster.scale_bar) draw_scale_bar(part, metres, poster.background);
    painter.drawImage(0, 0, part);
  }
  if (poster.of != Poster::Of::scene) {
    double metres = 0;
    QImage part = image.poster(each, poster.background, metres);
    if (poster.scale_bar) draw_scale_bar(part, metres, poster.background);
    painter.drawImage(poster.size.width() - each.width(), 0, part);
  }
  return picture;
}

}  // namespace plenoflame::desktop
