#include "widgets/image/image_view.h"
#include "widgets/controls/pointer.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "vtkPlenoflameCameraSource.h"

namespace plenoflame::desktop {
namespace {

constexpr double kLargestScale = 128;  ///< device pixels per image pixel
constexpr double kGridScale = 12;      ///< from here on pixels are separated by lines
constexpr double kValueScale = 56;     ///< from here on values are written in them
constexpr double kFullInk = 20;        ///< [logical pixel] that from which its ink is full
constexpr double kLeastInk = 0.3;
constexpr double kLeastCircle = 7;  ///< [logical pixel] diameter of an outline that is drawn
constexpr std::size_t kMostCircles = 20000;

}  // namespace

QColor type_colour(int type) {
  double rgb[3];
  vtkPlenoflameCameraSource::GetTypeColor(type, rgb);
  return QColor::fromRgbF(rgb[0], rgb[1], rgb[2]);
}

ImageView::ImageView(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setMinimumSize(120, 120);
  setAttribute(Qt::WA_OpaquePaintEvent);
}

void ImageView::set_image(std::shared_ptr<const ImagePyramid> image) {
  const bool same =
      image_ && image && image_->width() == image->width() && image_->height() == image->height();
  image_ = std::move(image);
  if (!same) fit();
  update();
}

void ImageView::set_tone(const ToneSettings& settings) {
  tone_ = settings;
  table_ = nullptr;
  update();
}

void ImageView::set_overlay(std::shared_ptr<const ImagePyramid> image, double white) {
  overlay_ = std::move(image);
  overlay_white_ = white > 0 ? white : 1;
  table_ = nullptr;
  update();
}

void ImageView::set_colours(std::shared_ptr<const Colours> colours) {
  colours_ = std::move(colours);
  table_ = nullptr;
  update();
}

void ImageView::make_tables() {
  table_ = std::make_unique<ToneTable>(tone_);
  grey_ = nullptr;
  grey_of_overlay_ = nullptr;
  if (!overlay_ && !colours_) return;
  ToneSettings grey = tone_;
  grey.map = ColourMap::grey;
  grey.saturation = 0;
  grey_ = std::make_unique<ToneTable>(grey);
  grey.white = overlay_white_;
  grey_of_overlay_ = std::make_unique<ToneTable>(grey);
}

void ImageView::set_caption(const QString& text) {
  if (text == caption_) return;
  caption_ = text;
  update();
}

void ImageView::set_smooth(bool on) {
  smooth_ = on;
  update();
}

QImage ImageView::drawn() {
  const QImage whole = grab().toImage();
  if (!image_ || image_->empty()) return whole;
  const double ratio = devicePixelRatioF();
  const QPointF from = ratio * to_widget({0, 0});
  const QPointF to = ratio * to_widget(QPointF(image_->width(), image_->height()));
  const QRect of_image(
      QPoint(static_cast<int>(std::ceil(from.x())), static_cast<int>(std::ceil(from.y()))),
      QPoint(static_cast<int>(to.x()) - 1, static_cast<int>(to.y()) - 1));
  return whole.copy(of_image.intersected(whole.rect()));
}

double ImageView::screen_scale() const {
  return scale_ / devicePixelRatioF();
}

void ImageView::fit() {
  fitted_ = true;
  if (!image_ || image_->empty() || width() < 1 || height() < 1) return;
  const double ratio = devicePixelRatioF();
  scale_ = std::min(width() * ratio / image_->width(), height() * ratio / image_->height());
  centre_ = {0.5 * image_->width(), 0.5 * image_->height()};
  moved();
}

void ImageView::set_scale(double scale) {
  if (!image_ || image_->empty()) return;
  fitted_ = false;
  const double least = 0.25 * std::min(static_cast<double>(width()) / image_->width(),
                                       static_cast<double>(height()) / image_->height());
  scale_ = std::clamp(scale, std::min(least, 1.0), kLargestScale);
  moved();
}

void ImageView::centre_on(double column, double row) {
  fitted_ = false;
  centre_ = {column, row};
  moved();
}

void ImageView::moved() {
  update();
  emit view_changed();
}

QPointF ImageView::to_image(QPointF widget) const {
  return centre_ + (widget - QPointF(0.5 * width(), 0.5 * height())) / screen_scale();
}

QPointF ImageView::to_widget(QPointF image) const {
  return QPointF(0.5 * width(), 0.5 * height()) + (image - centre_) * screen_scale();
}

void ImageView::set_micro_images(std::shared_ptr<const MicroImages> micro_images) {
  micro_images_ = std::move(micro_images);
  update();
}

void ImageView::set_selected_pixel(std::optional<Pixel> pixel) {
  selected_ = pixel;
  update();
}

void ImageView::set_selected_lens(std::optional<LensIndex> lens) {
  selected_lens_ = lens;
  update();
}

void ImageView::set_marks(std::vector<Pixel> marks) {
  marks_ = std::move(marks);
  update();
}

void ImageView::set_profile_line(const QLineF& line) {
  profile_ = line;
  update();
}

void ImageView::draw_image(QPainter& painter) {
  const double ratio = devicePixelRatioF();
  const int w = static_cast<int>(std::ceil(width() * ratio)),
            h = static_cast<int>(std::ceil(height() * ratio));
  if (canvas_.width() != w || canvas_.height() != h) canvas_ = QImage(w, h, QImage::Format_RGB32);
  canvas_.setDevicePixelRatio(1);
  const QRgb outside = palette().color(QPalette::Dark).rgb();
  const std::size_t level = image_->level_for(scale_);
  const Image& image = image_->level(level);
  const double shrink = std::ldexp(1.0, -static_cast<int>(level));
  // Column of the level for each column of the screen; -1 outside.
  const auto places = [&](int count, double centre, int limit, int whole) {
    std::vector<int> at(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      const double x = std::floor(centre + (i + 0.5 - 0.5 * count) / scale_);
      at[static_cast<std::size_t>(i)] =
          x < 0 || x >= whole ? -1 : std::min(limit - 1, static_cast<int>(x * shrink));
    }
    return at;
  };
  const bool mixed =
      overlay_ && overlay_->width() == image_->width() && overlay_->height() == image_->height();
  const Image* const other = mixed ? &overlay_->level(level) : nullptr;
  const auto mix = [&](float here, float there) {
    return qRgb(qRed((*grey_)(here)), qRed((*grey_of_overlay_)(there)), qRed((*grey_)(here)));
  };
  const bool coloured = colours_ && (*colours_)[0]->width() == image_->width() &&
                        (*colours_)[0]->height() == image_->height();
  const auto colour = [&](std::size_t place) {
    const auto part = [&](std::size_t c) {
      return qRed((*grey_)((*colours_)[c]->level(level).pixels[place]));
    };
    return qRgb(part(0), part(1), part(2));
  };
  const auto columns = places(w, centre_.x(), image.width, image_->width());
  const auto rows = places(h, centre_.y(), image.height, image_->height());
  for (int y = 0; y < h; ++y) {
    auto* const out = reinterpret_cast<QRgb*>(canvas_.scanLine(y));
    const int row = rows[static_cast<std::size_t>(y)];
    if (row < 0) {
      std::fill_n(out, w, outside);
      continue;
    }
    const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width);
    const float* const in = &image.pixels[first];
    const float* const beside = other ? &other->pixels[first] : nullptr;
    for (int x = 0; x < w; ++x) {
      const int column = columns[static_cast<std::size_t>(x)];
      out[x] = column < 0 ? outside
               : coloured ? colour(first + static_cast<std::size_t>(column))
               : beside   ? mix(in[column], beside[column])
                          : (*table_)(in[column]);
    }
  }
  canvas_.setDevicePixelRatio(ratio);
  painter.drawImage(0, 0, canvas_);
}

void ImageView::draw_values(QPainter& painter) {
  if (scale_ < kGridScale || smooth_) return;
  const QPointF low = to_image({0, 0}), high = to_image(QPointF(width(), height()));
  const int x0 = std::max(0, static_cast<int>(low.x())),
            x1 = std::min(image_->width() - 1, static_cast<int>(high.x())),
            y0 = std::max(0, static_cast<int>(low.y())),
            y1 = std::min(image_->height() - 1, static_cast<int>(high.y()));
  painter.setPen(QColor(128, 128, 128, 110));
  for (int x = x0; x <= x1 + 1; ++x)
    painter.drawLine(to_widget(QPointF(x, y0)), to_widget(QPointF(x, y1 + 1)));
  for (int y = y0; y <= y1 + 1; ++y)
    painter.drawLine(to_widget(QPointF(x0, y)), to_widget(QPointF(x1 + 1, y)));
  if (scale_ < kValueScale) return;
  QFont font = painter.font();
  font.setPixelSize(std::clamp(static_cast<int>(screen_scale() / 6), 8, 13));
  painter.setFont(font);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float value = image_->level(0).at(x, y);
      const QColor back((*table_)(value));
      painter.setPen(back.lightnessF() > 0.5 ? Qt::black : Qt::white);
      const QString text =
          QString::fromStdString(readable_quantity(static_cast<double>(value), dimension_, 3))
              .replace(' ', '\n');
      painter.drawText(QRectF(to_widget(QPointF(x, y)), to_widget(QPointF(x + 1, y + 1))),
                       Qt::AlignCenter, text);
    }
}

void ImageView::draw_micro_images(QPainter& painter) {
  if (!micro_images_) return;
  const Camera& camera = micro_images_->camera();
  const SensorSpec& sensor = camera.spec().sensor;
  const double pixel = sensor.pixel_pitch;
  if (micro_images_->spacing() / pixel * screen_scale() < kLeastCircle && !selected_lens_) return;
  const QPointF low = to_image({0, 0}), high = to_image(QPointF(width(), height()));
  const Vec2 upper = camera.sensor_point(low.x(), low.y()),
             lower = camera.sensor_point(high.x(), high.y());
  const double scale = shortest_pitch(camera.spec().array) / micro_images_->spacing(),
               margin = 2 * longest_pitch(camera.spec().array);
  std::vector<LensIndex> lenses;
  const bool all = micro_images_->spacing() / pixel * screen_scale() >= kLeastCircle;
  if (all)
    lenses = camera.lattice().within({scale * lower.x - margin, scale * lower.y - margin},
                                     {scale * upper.x + margin, scale * upper.y + margin});
  if (lenses.size() > kMostCircles) lenses.clear();
  const auto draw = [&](LensIndex lens, const QPen& pen, double least) {
    const MicroImages::Place place = micro_images_->place(lens);
    if (place.dark) return;
    const Vec2 centre = camera.image_point(place.centre);
    const double across = std::max(least, place.radius / sensor.pixel().x * screen_scale());
    const double down = std::max(least, place.radius / sensor.pixel().y * screen_scale());
    painter.setPen(pen);
    painter.drawEllipse(to_widget(QPointF(centre.x, centre.y)), across, down);
  };
  painter.setBrush(Qt::NoBrush);
  // The lattice extends beyond the sensor, where there is no picture.
  painter.save();
  painter.setClipRect(QRectF(to_widget({0, 0}), to_widget(QPointF(sensor.columns, sensor.rows))));
  // Many small circles are faint, as they would be all that is seen of the picture.
  const double spacing = micro_images_->spacing() / pixel * screen_scale();
  const double ink = std::clamp(spacing / kFullInk, kLeastInk, 1.0);
  for (const LensIndex lens : lenses) {
    QColor colour = type_colour(camera.lattice().type(lens));
    colour.setAlphaF(ink);
    draw(lens, QPen(colour, 1.2 * ink), 0);
  }
  painter.restore();
  if (selected_lens_) draw(*selected_lens_, QPen(QColor(255, 42, 109), 2.5), 4);
}

void ImageView::draw_marks(QPainter& painter) {
  const double side = std::max(2.0, screen_scale());
  const QColor mark(255, 42, 109);
  for (const Pixel& pixel : marks_) {
    const QPointF corner = to_widget(QPointF(pixel.column + 0.5, pixel.row + 0.5));
    painter.fillRect(QRectF(corner.x() - 0.5 * side, corner.y() - 0.5 * side, side, side),
                     QColor(mark.red(), mark.green(), mark.blue(), 150));
  }
  if (selected_) {
    const QPointF middle = to_widget(QPointF(selected_->column + 0.5, selected_->row + 0.5));
    const double half = std::max(5.0, 0.5 * screen_scale());
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(Qt::black, 3));
    painter.drawRect(QRectF(middle.x() - half, middle.y() - half, 2 * half, 2 * half));
    painter.setPen(QPen(mark, 1.6));
    painter.drawRect(QRectF(middle.x() - half, middle.y() - half, 2 * half, 2 * half));
  }
  if (profile_.length() > 0) {
    painter.setPen(QPen(Qt::black, 3));
    painter.drawLine(to_widget(profile_.p1()), to_widget(profile_.p2()));
    painter.setPen(QPen(QColor(255, 214, 10), 1.4));
    painter.drawLine(to_widget(profile_.p1()), to_widget(profile_.p2()));
  }
}

void ImageView::set_badge(const QString& text) {
  if (text == badge_) return;
  badge_ = text;
  update();
}

void ImageView::set_empty_text(const QString& text) {
  if (text == empty_text_) return;
  empty_text_ = text;
  update();
}

namespace {

/// The size that a text takes, with a margin; long texts wrap.
QSize room_of_text(const QPainter& painter, const QString& text) {
  const QRect view = painter.viewport().adjusted(0, 0, -28, 0);
  return painter.fontMetrics()
      .boundingRect(view, Qt::AlignCenter | Qt::TextWordWrap, text)
      .adjusted(-6, -3, 6, 3)
      .size();
}

}  // namespace

void ImageView::draw_badge(QPainter& painter) {
  if (badge_.isEmpty()) return;
  const QRect place(QPoint(8, 8), room_of_text(painter, badge_));
  painter.fillRect(place, QColor(230, 159, 0));
  painter.setPen(Qt::black);
  painter.drawText(place, Qt::AlignCenter | Qt::TextWordWrap, badge_);
}

void ImageView::draw_caption(QPainter& painter) {
  if (caption_.isEmpty()) return;
  const QSize needed = room_of_text(painter, caption_);
  const QRect place(QPoint(8, height() - 8 - needed.height()), needed);
  painter.fillRect(place, QColor(0, 0, 0, 170));
  painter.setPen(Qt::white);
  painter.drawText(place, Qt::AlignCenter | Qt::TextWordWrap, caption_);
}

void ImageView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (!image_ || image_->empty()) {
    painter.fillRect(rect(), palette().color(QPalette::Dark));
    painter.setPen(palette().color(QPalette::BrightText));
    painter.drawText(rect().adjusted(12, 0, -12, 0), Qt::AlignCenter | Qt::TextWordWrap,
                     empty_text_.isEmpty() ? tr("no picture yet") : empty_text_);
    return;
  }
  if (!table_) make_tables();
  draw_image(painter);
  painter.setRenderHint(QPainter::Antialiasing);
  draw_values(painter);
  draw_micro_images(painter);
  draw_marks(painter);
  draw_badge(painter);
  draw_caption(painter);
  if (hasFocus()) {
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setPen(palette().color(QPalette::Highlight));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void ImageView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (fitted_) fit();
}

void ImageView::zoom(double factor, QPointF about) {
  const QPointF fixed = to_image(about);
  set_scale(scale_ * factor);
  centre_ += fixed - to_image(about);
  moved();
}

void ImageView::wheelEvent(QWheelEvent* event) {
  zoom(std::pow(2.0, event->angleDelta().y() / 240.0), event->position());
  event->accept();
}

void ImageView::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton && event->button() != Qt::MiddleButton) return;
  pressed_ = last_ = pointer_place(event);
  dragging_ = false;
  profiling_ = (event->modifiers() & Qt::ControlModifier) != 0;
}

void ImageView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF at = pointer_place(event);
  if ((event->buttons() & (Qt::LeftButton | Qt::MiddleButton)) != 0) {
    if ((at - pressed_).manhattanLength() > 4) dragging_ = true;
    if (profiling_) {
      profile_ = QLineF(to_image(pressed_), to_image(at));
      update();
    } else if (dragging_) {
      fitted_ = false;
      centre_ -= (at - last_) / screen_scale();
      moved();
    }
    last_ = at;
  }
  if (!image_ || image_->empty()) return;
  const QPointF p = to_image(at);
  const int column = static_cast<int>(std::floor(p.x())), row = static_cast<int>(std::floor(p.y()));
  if (column < 0 || row < 0 || column >= image_->width() || row >= image_->height())
    emit hovered(-1, -1, 0);
  else
    emit hovered(column, row, static_cast<double>(image_->level(0).at(column, row)));
}

void ImageView::mouseReleaseEvent(QMouseEvent* event) {
  if (profiling_) {
    profiling_ = false;
    if (profile_.length() > 0) emit profile_drawn(profile_);
    return;
  }
  if (dragging_ || event->button() != Qt::LeftButton || !image_ || image_->empty()) return;
  const QPointF p = to_image(pointer_place(event));
  const int column = static_cast<int>(std::floor(p.x())), row = static_cast<int>(std::floor(p.y()));
  if (column < 0 || row < 0 || column >= image_->width() || row >= image_->height()) return;
  if ((event->modifiers() & Qt::ShiftModifier) != 0)
    emit lens_clicked(column, row);
  else
    emit pixel_clicked(column, row);
}

void ImageView::leaveEvent(QEvent*) {
  emit hovered(-1, -1, 0);
}

void ImageView::keyPressEvent(QKeyEvent* event) {
  const QPointF middle(0.5 * width(), 0.5 * height());
  const auto step = [&](int x, int y) {
    if (!image_ || image_->empty()) return;
    const Pixel from = selected_.value_or(Pixel{image_->width() / 2, image_->height() / 2});
    const int column = std::clamp(from.column + x, 0, image_->width() - 1),
              row = std::clamp(from.row + y, 0, image_->height() - 1);
    emit pixel_clicked(column, row);
  };
  const int stride = (event->modifiers() & Qt::ShiftModifier) != 0 ? 10 : 1;
  switch (event->key()) {
    case Qt::Key_Left:
      return step(-stride, 0);
    case Qt::Key_Right:
      return step(stride, 0);
    case Qt::Key_Up:
      return step(0, -stride);
    case Qt::Key_Down:
      return step(0, stride);
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom(1.5, middle);
    case Qt::Key_Minus:
      return zoom(1 / 1.5, middle);
    case Qt::Key_F:
      return fit();
    case Qt::Key_1:
      return zoom(1 / scale_, middle);
    default:
      QWidget::keyPressEvent(event);
  }
}

}  // namespace plenoflame::desktop
