#include "widgets/scene/section_view.h"

#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>
#include <algorithm>
#include <array>
#include <cmath>

#include "colour_map.h"
#include "model/flame_glow.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/surface_shape.h"
#include "widgets/controls/pointer.h"
#include "widgets/image/image_view.h"
#include "widgets/scene/scene_labels.h"

namespace plenoflame::desktop {
namespace {

/// Half the width of a microlens in a plane beside its middle [m]; 0: it is not met.
/// @param off of the plane from the middle @param horizontal the plane is camera x, z
double half_chord(const MicrolensAperture& aperture, double off, bool horizontal) {
  const double square = aperture.radius() * aperture.radius() - off * off;
  double half = square > 0 ? std::sqrt(square) : 0;
  for (int pair = 0; pair < aperture.pairs(); ++pair) {
    const Vec2 n = aperture.normal(pair);
    const double along = std::fabs(horizontal ? n.x : n.y);
    const double rest = aperture.half_width(pair) - std::fabs((horizontal ? n.y : n.x) * off);
    if (along * half > rest) half = std::max(0.0, rest / along);
  }
  return half;
}

constexpr int kFlameSide = 160;   ///< points along the longer side of the flame's picture
constexpr double kLeastLens = 5;  ///< [screen pixel] pitch from which microlenses are drawn
constexpr int kArcPoints = 24;

/// Sag of a sphere; 0 beyond it.
double sphere_sag(double radius, double height) {
  if (!std::isfinite(radius) || radius == 0) return 0;
  const double c = height / radius;
  return std::fabs(c) < 1 ? radius * (1 - std::sqrt(1 - c * c)) : radius;
}

}  // namespace

QColor chosen_colour() {
  return {255, 42, 109};
}

QColor status_colour(RayStatus status, bool dark_background) {
  switch (status) {
    case RayStatus::reached:
      return dark_background ? QColor(95, 190, 255) : QColor(0, 105, 180);
    case RayStatus::vignetted:
      return QColor(217, 95, 2);
    case RayStatus::total_internal_reflection:
      return QColor(200, 60, 160);
    case RayStatus::missed:
      return QColor(128, 128, 128);
  }
  return Qt::gray;
}

SectionView::SectionView(QWidget* parent) : QWidget(parent) {
  setMinimumSize(160, 100);
  setFocusPolicy(Qt::ClickFocus);
  setMouseTracking(true);
}

void SectionView::set_scene(std::shared_ptr<const CompiledScene> scene) {
  const bool first = !scene_;
  scene_ = std::move(scene);
  sample_flame();
  if (first) touched_ = false;
  if (!touched_) aim();
  update();
}

void SectionView::set_rays(std::shared_ptr<const SelectedRays> rays, int chosen) {
  rays_ = std::move(rays);
  highlighted_ = chosen;
  if (is_close()) aim();
  update();
}

void SectionView::set_highlighted(int ray) {
  highlighted_ = ray;
  update();
}

void SectionView::set_horizontal(bool on) {
  touched_ = false;
  horizontal_ = on;
  sample_flame();
  aim();
  update();
}

void SectionView::show_part(Part part) {
  touched_ = false;
  part_ = part;
  aim();
  update();
}

QPointF SectionView::project(Vec3 world) const {
  const Vec3 p = scene_->camera.to_world().inverse().point(world);
  return {p.z, horizontal_ ? p.x : -p.y};
}

QPointF SectionView::to_widget(double z, double height) const {
  return {0.5 * width() - (z - centre_.x()) * scale_,
          middle_row() - (height - centre_.y()) * scale_};
}

QPointF SectionView::from_widget(QPointF p) const {
  return {centre_.x() - (p.x() - 0.5 * width()) / scale_,
          centre_.y() - (p.y() - middle_row()) / scale_};
}

/// Height of the title's line above the drawing [logical pixel].
double SectionView::title_height() const {
  return fontMetrics().height() + 6.0;
}

double SectionView::middle_row() const {
  return 0.5 * (height() + title_height());
}

void SectionView::sample_flame() {
  flame_ = {};
  if (!scene_ || !scene_->medium) return;
  const Medium& medium = *scene_->medium;
  const Box box = medium.bounds();
  if (box.empty()) return;
  double z0 = 1e300, z1 = -1e300, h0 = 1e300, h1 = -1e300;
  for (const double x : {box.lower.x, box.upper.x})
    for (const double y : {box.lower.y, box.upper.y})
      for (const double z : {box.lower.z, box.upper.z}) {
        const QPointF p = project({x, y, z});
        z0 = std::min(z0, p.x());
        z1 = std::max(z1, p.x());
        h0 = std::min(h0, p.y());
        h1 = std::max(h1, p.y());
      }
  const double step = std::max(z1 - z0, h1 - h0) / kFlameSide;
  if (!std::isfinite(step) || step <= 0) return;
  const int columns = std::max(1, static_cast<int>((z1 - z0) / step)),
            rows = std::max(1, static_cast<int>((h1 - h0) / step));
  std::vector<MediumSample> samples;
  std::vector<Vec3> places;
  double cold = 1e300, hot = 0, dense = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double z = z1 - (column + 0.5) * step, h = h1 - (row + 0.5) * step;
      const Vec3 local = horizontal_ ? Vec3{h, 0, z} : Vec3{0, -h, z};
      places.push_back(scene_->camera.to_world().point(local));
      samples.push_back(medium.sample(places.back()));
      if (samples.back().absorption <= 0) continue;
      cold = std::min(cold, samples.back().temperature);
      hot = std::max(hot, samples.back().temperature);
      dense = std::max(dense, samples.back().absorption);
    }
  if (dense == 0)  // a clear flame: by what it emits
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i].absorption = glow(medium, places[i]);
      if (samples[i].absorption <= 0) continue;
      cold = std::min(cold, samples[i].temperature);
      hot = std::max(hot, samples[i].temperature);
      dense = std::max(dense, samples[i].absorption);
    }
  flame_ = QImage(columns, rows, QImage::Format_ARGB32_Premultiplied);
  flame_.fill(Qt::transparent);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const MediumSample& s =
          samples[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column)];
      if (s.absorption <= 0) continue;
      const double t = hot > cold ? (s.temperature - cold) / (hot - cold) : 0.5;
      const Rgb c = flame_colour(ColourMap::inferno, t);
      const int alpha = static_cast<int>(70 + 170 * std::sqrt(s.absorption / dense));
      flame_.setPixel(column, row, qPremultiply(qRgba(c.red, c.green, c.blue, alpha)));
    }
  flame_place_ = QRectF(z1, h1, -columns * step, -rows * step);
}

void SectionView::aim() {
  if (!scene_ || width() < 2) return;
  const Camera& camera = scene_->camera;
  double z0 = camera.sensor(), z1 = 0, half = 0;
  const CameraSpec& spec = camera.spec();
  const double sensor = 0.5 * (horizontal_ ? spec.sensor.size().x : spec.sensor.size().y);
  half = std::max(sensor, 0.6 * camera.lens_first_order().entrance_pupil_diameter);
  double middle = 0;
  if (part_ == Part::scene && !flame_.isNull()) {
    z1 = flame_place_.left();
    half = std::max({half, std::fabs(flame_place_.top()), std::fabs(flame_place_.bottom())});
  }
  if (part_ == Part::flame && !flame_.isNull()) {
    const QRectF place = flame_place_.normalized();
    z0 = place.left();
    z1 = place.right();
    half = 0.5 * place.height();
    middle = place.center().y();
  }
  if (is_close() && spec.array.present) {
    double column = 0.5 * spec.sensor.columns, row = 0.5 * spec.sensor.rows;
    if (rays_ && rays_->selection.kind == Selection::Kind::pixel) {
      column = rays_->selection.column + 0.5;
      row = rays_->selection.row + 0.5;
    }
    const Vec2 place = camera.sensor_point(column, row);
    middle = horizontal_ ? place.x : -place.y;
    half = (part_ == Part::array ? 2.5 : 0.75) * spec.array.pitch;
    z1 = camera.array_front() + spec.array.thickness;
    z0 -= 0.05 * (z1 - z0);
  }
  scale_ = 0.9 * std::min(width() / std::max(1e-9, z1 - z0),
                          std::max(20.0, height() - title_height()) / (2 * half));
  centre_ = {0.5 * (z0 + z1), middle};
}

void SectionView::draw_flame(QPainter& painter) {
  if (flame_.isNull()) return;
  const QPointF a = to_widget(flame_place_.left(), flame_place_.top()),
                b = to_widget(flame_place_.right(), flame_place_.bottom());
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.drawImage(QRectF(a, b), flame_);
}

void SectionView::draw_lens(QPainter& painter) {
  const MainLensSpec& lens = scene_->camera.spec().lens;
  const bool dark = palette().color(QPalette::Base).lightness() < 128;
  const QPen edge(dark ? QColor(120, 175, 200) : QColor(60, 120, 155), 1.4);
  const QColor glass(110, 180, 215, 70);
  const QPen stop(palette().color(QPalette::Text), 3);
  const auto draw_stop = [&](double z, double diameter) {
    painter.setPen(stop);
    const double outer = 0.5 * diameter * 1.35;
    for (const double side : {-1.0, 1.0})
      painter.drawLine(to_widget(z, side * 0.5 * diameter), to_widget(z, side * outer));
  };
  if (lens.surfaces.empty()) {
    const double half = 0.5 * lens.diameter;
    painter.setPen(edge);
    painter.drawLine(to_widget(0, -half), to_widget(0, half));
    draw_stop(0, lens.diameter);
    return;
  }
  const auto profile = [this](const SurfaceSpec& surface, double z) {
    std::vector<QPointF> points;
    const double half = std::min(0.5 * surface.diameter, greatest_height(surface));
    for (int i = -kArcPoints; i <= kArcPoints; ++i) {
      const double h = half * i / kArcPoints;
      const Vec2 place = horizontal_ ? Vec2{h, 0} : Vec2{0, -h};
      points.emplace_back(z - surface_sag(surface, place), h);
    }
    return points;
  };
  double z = 0;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const SurfaceSpec& surface = lens.surfaces[i];
    const bool is_glass = surface.index != 1 && i + 1 < lens.surfaces.size();
    const double before = i == 0 ? 1 : lens.surfaces[i - 1].index;
    const auto front = profile(surface, z);
    QPainterPath path;
    for (std::size_t k = 0; k < front.size(); ++k) {
      const QPointF p = to_widget(front[k].x(), front[k].y());
      if (k == 0)
        path.moveTo(p);
      else
        path.lineTo(p);
    }
    if (is_glass) {
      const auto back = profile(lens.surfaces[i + 1], z - surface.thickness);
      QPainterPath body = path;
      for (std::size_t k = back.size(); k-- > 0;) body.lineTo(to_widget(back[k].x(), back[k].y()));
      body.closeSubpath();
      painter.fillPath(body, glass);
      painter.setPen(edge);
      painter.setBrush(Qt::NoBrush);
      painter.drawPath(body);
    } else if (before != 1 || surface.index != 1) {
      painter.setPen(edge);
      painter.drawPath(path);
    }
    if (surface.stop) draw_stop(z, surface.diameter);
    z -= surface.thickness;
  }
}

void SectionView::draw_array(QPainter& painter) {
  const Camera& camera = scene_->camera;
  const CameraSpec& spec = camera.spec();
  const double half = 0.5 * (horizontal_ ? spec.sensor.size().x : spec.sensor.size().y);
  painter.setPen(QPen(palette().color(QPalette::Text), 2));
  painter.drawLine(to_widget(camera.sensor(), -half), to_widget(camera.sensor(), half));
  const double pixel = horizontal_ ? spec.sensor.pixel().x : spec.sensor.pixel().y;
  const QPointF low = from_widget(QPointF(0, height())), high = from_widget(QPointF(0, 0));
  if (pixel * scale_ > 4) {  // pixels as ticks
    painter.setPen(QPen(palette().color(QPalette::Text), 1));
    const double first = std::max(-half, low.y()), last = std::min(half, high.y());
    for (double i = std::ceil((first + half) / pixel); - half + i * pixel <= last; ++i) {
      const QPointF p = to_widget(camera.sensor(), -half + i * pixel);
      painter.drawLine(p, p + QPointF(5, 0));
    }
  }
  if (!spec.array.present) return;
  const double front = camera.array_front(), back = camera.array_back();
  if (spec.array.pitch * scale_ < kLeastLens) {
    painter.fillRect(QRectF(to_widget(front, half), to_widget(back, -half))
                         .normalized()
                         .adjusted(-0.5, 0, 0.5, 0),
                     QColor(110, 180, 215, 150));
    return;
  }
  // The microlenses that the plane cuts, as large as it cuts them.
  double across = 0;
  if (rays_ && rays_->selection.kind == Selection::Kind::pixel) {
    const Vec2 place =
        camera.sensor_point(rays_->selection.column + 0.5, rays_->selection.row + 0.5);
    across = horizontal_ ? place.y : place.x;
  }
  const double pitch = longest_pitch(spec.array), y0 = std::max(low.y(), -1.1 * half) - pitch,
               y1 = std::min(high.y(), 1.1 * half) + pitch;
  const Vec2 a = horizontal_ ? Vec2{y0, across - 0.5 * pitch} : Vec2{across - 0.5 * pitch, -y1};
  const Vec2 b = horizontal_ ? Vec2{y1, across + 0.5 * pitch} : Vec2{across + 0.5 * pitch, -y0};
  for (const LensIndex lens : camera.lattice().within(a, b)) {
    const Vec2 centre = camera.lattice().centre(lens);
    const double h = horizontal_ ? centre.x : -centre.y;
    const int type = camera.lattice().type(lens);
    const Microlens& micro = camera.microlenses()[static_cast<std::size_t>(type)];
    const double off = (horizontal_ ? centre.y : centre.x) - across;
    const double r = half_chord(camera.aperture(), off, horizontal_);
    if (r <= 0) continue;
    QPainterPath path;
    for (int i = -kArcPoints; i <= kArcPoints; ++i) {
      const double y = r * i / kArcPoints;
      const QPointF p =
          to_widget(front - sphere_sag(micro.radius_front, std::hypot(y, off)), h + y);
      if (i == -kArcPoints)
        path.moveTo(p);
      else
        path.lineTo(p);
    }
    for (int i = kArcPoints; i >= -kArcPoints; --i) {
      const double y = r * i / kArcPoints;
      path.lineTo(to_widget(back + sphere_sag(micro.radius_back, std::hypot(y, off)), h + y));
    }
    path.closeSubpath();
    QColor fill = type_colour(type);
    fill.setAlpha(90);
    painter.fillPath(path, fill);
    painter.setPen(QPen(type_colour(type), 1.2));
    painter.drawPath(path);
  }
}

void SectionView::draw_rays(QPainter& painter) {
  if (!rays_ || rays_->scene != scene_) return;
  const bool dark = palette().color(QPalette::Base).lightness() < 128;
  const RayPaths& paths = rays_->paths;
  const auto draw = [&](std::size_t i, bool strong) {
    const RayPath& ray = paths.rays[i];
    QPolygonF line;
    for (std::size_t k = 0; k < ray.count; ++k) {
      const QPointF p = project(paths.vertices[ray.first + k].position);
      line << to_widget(p.x(), p.y());
    }
    QColor ink = strong ? chosen_colour() : status_colour(ray.status.status, dark);
    if (!strong) ink.setAlpha(paths.rays.size() > 100 ? 90 : 170);
    painter.setPen(QPen(ink, strong ? 2.6 : 1));
    painter.drawPolyline(line);
  };
  for (std::size_t i = 0; i < paths.rays.size(); ++i) draw(i, false);
  if (highlighted_ >= 0 && static_cast<std::size_t>(highlighted_) < paths.rays.size())
    draw(static_cast<std::size_t>(highlighted_), true);
}

/// Texts stay readable over lenses and rays.
void SectionView::draw_text(QPainter& painter, QPointF top_left, const QString& text) {
  const QRectF place(top_left, QSizeF(painter.fontMetrics().horizontalAdvance(text) + 1,
                                      painter.fontMetrics().height()));
  QColor ground = palette().color(QPalette::Base);
  ground.setAlphaF(kTextGround);
  painter.fillRect(place.adjusted(-2, 0, 2, 0), ground);
  painter.setPen(palette().color(QPalette::Text));
  painter.drawText(place, Qt::AlignCenter, text);
}

void SectionView::draw_scale(QPainter& painter) {
  // A bar of a round length, about a sixth of the width.
  const double wanted = width() / 6.0 / scale_;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  double bar = power;
  for (const double digit : {5.0, 2.0, 1.0})
    if (digit * power <= wanted) {
      bar = digit * power;
      break;
    }
  const double y = height() - 14.0, x = 14;
  painter.setPen(QPen(palette().color(QPalette::Text), 2));
  painter.drawLine(QPointF(x, y), QPointF(x + bar * scale_, y));
  const int line = painter.fontMetrics().height();
  draw_text(painter, QPointF(x, y - 4 - line),
            QString::fromStdString(readable_quantity(bar, Dimension::length, 3)));
  draw_text(painter, QPointF(8, 4),
            horizontal_ ? tr("section, from above") : tr("section, from the side"));
  draw_names(painter);
}

/// Draws the names of the parts, each above its part, or beside it without room above. No name
/// covers another, the sensor or the array.
void SectionView::draw_names(QPainter& painter) {
  const Camera& camera = scene_->camera;
  const CameraSpec& spec = camera.spec();
  struct Name {
    QString text;
    double begin, end, height;  ///< [m] along the axis, and from it
  };
  std::vector<Name> names;
  const double sensor = 0.5 * (horizontal_ ? spec.sensor.size().x : spec.sensor.size().y);
  if (!flame_.isNull())
    names.push_back({tr("flame"), flame_place_.left(), flame_place_.right(), flame_place_.top()});
  double lens = 0.5 * spec.lens.diameter, last = 0;
  for (const SurfaceSpec& surface : spec.lens.surfaces) {
    lens = std::max(lens, 0.5 * surface.diameter);
    last -= &surface == &spec.lens.surfaces.back() ? 0 : surface.thickness;
  }
  names.push_back({tr("main lens"), last, 0, lens});
  if (spec.array.present)
    names.push_back({tr("microlenses"), camera.array_back(), camera.array_front(), sensor});
  names.push_back({tr("sensor"), camera.sensor(), camera.sensor(), sensor});
  const QFontMetrics metrics = painter.fontMetrics();
  std::vector<QRectF> taken;
  // Lines that a name beside its part must not cross.
  std::vector<QRectF> lines;
  for (const Name& name : names)
    if (name.height == sensor && name.text != tr("flame"))
      lines.push_back(
          QRectF(to_widget(name.begin, sensor), to_widget(name.end, -sensor)).normalized());
  names_.clear();
  painter.setPen(palette().color(QPalette::Text));
  for (const Name& name : names) {
    const double x = to_widget(0.5 * (name.begin + name.end), 0).x();
    if (x < 0 || x > width()) continue;
    const double wide = metrics.horizontalAdvance(name.text), high = metrics.height();
    const double above = to_widget(name.begin, name.height).y() - high - 3;
    double left = x - 0.5 * wide;
    if (above < 2 * high) {  // there is no room above it
      const double a = to_widget(name.begin, 0).x(), b = to_widget(name.end, 0).x();
      const double right = std::max(a, b) + 6, other = std::min(a, b) - 6 - wide;
      const auto is_free = [&](double from) {
        return from >= 4 && from + wide <= width() - 4 &&
               std::none_of(lines.begin(), lines.end(), [&](const QRectF& line) {
                 return line.left() <= from + wide && line.right() >= from;
               });
      };
      left = is_free(right) || (!is_free(other) && right + wide <= width()) ? right : other;
    }
    left = std::clamp(left, 4.0, std::max(4.0, width() - wide - 4));
    double top = std::clamp(above, 2.0 * high, std::max(2.0 * high, this->height() - 3.0 * high));
    const auto meets = [&](const QRectF& r) {
      return r.intersects(QRectF(left - 4, top, wide + 8, high));
    };
    while (std::any_of(taken.begin(), taken.end(), meets)) top -= high;
    taken.emplace_back(left - 4, top, wide + 8, high);
    names_.emplace_back(name.text, QRectF(left, top, wide + 1, high));
    draw_text(painter, names_.back().second.topLeft(), name.text);
  }
}

void SectionView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  if (!scene_) return draw_notice(painter);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(palette().color(QPalette::Mid), 1, Qt::DashDotLine));
  painter.drawLine(QPointF(0, to_widget(0, 0).y()), QPointF(width(), to_widget(0, 0).y()));
  draw_flame(painter);
  draw_lens(painter);
  draw_array(painter);
  draw_rays(painter);
  draw_scale(painter);
  draw_notice(painter);
}

void SectionView::set_notice(const QString& text) {
  if (text == notice_) return;
  notice_ = text;
  update();
}

void SectionView::draw_notice(QPainter& painter) {
  if (notice_.isEmpty()) return;
  const QRect room = rect().adjusted(4, 0, -4, 0);
  const QRect needed = painter.boundingRect(room, Qt::TextWordWrap, notice_);
  painter.fillRect(QRect(0, 0, width(), needed.height() + 8), QColor(179, 38, 30));
  painter.setPen(Qt::white);
  painter.drawText(room.adjusted(0, 4, 0, 0), Qt::TextWordWrap, notice_);
}

void SectionView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  aim();
}

void SectionView::wheelEvent(QWheelEvent* event) {
  touched_ = true;
  const QPointF fixed = from_widget(event->position());
  scale_ = std::clamp(scale_ * std::pow(2.0, event->angleDelta().y() / 240.0), 10.0, 1e9);
  centre_ += fixed - from_widget(event->position());
  update();
  event->accept();
}

void SectionView::mousePressEvent(QMouseEvent* event) {
  pressed_ = last_ = pointer_place(event);
  dragging_ = false;
}

void SectionView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF at = pointer_place(event);
  if ((event->buttons() & Qt::LeftButton) == 0) {
    if (!scene_) return;
    LensIndex lens;
    emit pointed(lens_at(from_widget(at), lens) ? microlens_text(*scene_, lens)
                                                : place_text(*scene_, world_at(from_widget(at))));
    return;
  }
  if ((at - pressed_).manhattanLength() > 4) dragging_ = true;
  if (!dragging_) return;
  touched_ = true;
  centre_ += from_widget(last_) - from_widget(at);
  last_ = at;
  update();
}

void SectionView::mouseReleaseEvent(QMouseEvent* event) {
  if (dragging_ || !scene_ || event->button() != Qt::LeftButton) return;
  const QPointF p = from_widget(pointer_place(event));
  LensIndex lens;
  if (lens_at(p, lens)) {
    emit lens_clicked(lens);
    return;
  }
  if (flame_.isNull()) return;
  if (flame_place_.normalized().contains(p)) emit point_clicked(world_at(p));
}

void SectionView::leaveEvent(QEvent*) {
  emit pointed({});
}

bool SectionView::lens_at(QPointF place, LensIndex& lens) const {
  const double reach = 8 / scale_;
  const Camera& camera = scene_->camera;
  if (!camera.has_array() || place.x() >= camera.array_front() + reach ||
      place.x() <= camera.sensor() - reach)
    return false;
  lens = camera.lattice().nearest(horizontal_ ? Vec2{place.y(), 0} : Vec2{0, -place.y()});
  return true;
}

Vec3 SectionView::world_at(QPointF place) const {
  return scene_->camera.to_world().point(horizontal_ ? Vec3{place.y(), 0, place.x()}
                                                     : Vec3{0, -place.y(), place.x()});
}

}  // namespace plenoflame::desktop
