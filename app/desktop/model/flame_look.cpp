#include "model/flame_look.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace plenoflame::desktop {
namespace {

constexpr double kLeastStep = 1e-3;  ///< between the places of two points
constexpr double kMostDensity = 100;

struct MapName {
  ColourMap map;
  const char* name;
};
constexpr std::array<MapName, 3> kMaps{{{ColourMap::inferno, "inferno"},
                                        {ColourMap::viridis, "viridis"},
                                        {ColourMap::cividis, "cividis"}}};

constexpr double kMostStops = 10;
constexpr std::array<const char*, 4> kDrawings{"eye", "emission", "absorption", "surfaces"};

bool is_share(double value) {
  return value >= 0 && value <= 1;
}

}  // namespace

bool operator==(const OpacityPoint& a, const OpacityPoint& b) {
  return a.place == b.place && a.opacity == b.opacity;
}

bool operator==(const FlameLook& a, const FlameLook& b) {
  return a.map == b.map && a.drawing == b.drawing && a.exposure == b.exposure &&
         a.automatic == b.automatic && a.cold == b.cold && a.hot == b.hot &&
         a.density == b.density && a.points == b.points;
}

double opacity_at(const std::vector<OpacityPoint>& points, double place) {
  if (points.empty()) return 1;
  const auto after =
      std::upper_bound(points.begin(), points.end(), place,
                       [](double value, const OpacityPoint& p) { return value < p.place; });
  if (after == points.begin()) return points.front().opacity;
  if (after == points.end()) return points.back().opacity;
  const OpacityPoint &a = *std::prev(after), &b = *after;
  return a.opacity + (place - a.place) / (b.place - a.place) * (b.opacity - a.opacity);
}

std::size_t add_point(std::vector<OpacityPoint>& points, const OpacityPoint& point) {
  const double place = std::clamp(point.place, kLeastStep, 1 - kLeastStep);
  const auto after =
      std::upper_bound(points.begin(), points.end(), place,
                       [](double value, const OpacityPoint& p) { return value < p.place; });
  const auto at = points.insert(after, {place, point.opacity});
  const auto number = static_cast<std::size_t>(at - points.begin());
  move_point(points, number, point);
  return number;
}

void move_point(std::vector<OpacityPoint>& points, std::size_t number, const OpacityPoint& to) {
  if (number >= points.size()) return;
  OpacityPoint& point = points[number];
  point.opacity = std::clamp(to.opacity, 0.0, 1.0);
  if (number == 0 || number + 1 == points.size()) return;
  const double low = points[number - 1].place + kLeastStep,
               high = points[number + 1].place - kLeastStep;
  point.place = low < high ? std::clamp(to.place, low, high) : 0.5 * (low + high);
}

bool remove_point(std::vector<OpacityPoint>& points, std::size_t number) {
  if (number == 0 || number + 1 >= points.size()) return false;
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(number));
  return true;
}

QByteArray look_to_text(const FlameLook& look) {
  QJsonArray points;
  for (const OpacityPoint& p : look.points) points.append(QJsonArray{p.place, p.opacity});
  QJsonObject object;
  for (const MapName& m : kMaps)
    if (m.map == look.map) object["colours"] = m.name;
  object["drawing"] = kDrawings[static_cast<std::size_t>(look.drawing)];
  object["exposure"] = look.exposure;
  object["automatic"] = look.automatic;
  object["cold"] = look.cold;
  object["hot"] = look.hot;
  object["density"] = look.density;
  object["points"] = points;
  return QJsonDocument(object).toJson(QJsonDocument::Compact);
}

std::optional<FlameLook> look_from_text(const QByteArray& text) {
  const QJsonObject object = QJsonDocument::fromJson(text).object();
  FlameLook look;
  const QString name = object["colours"].toString();
  const auto map = std::find_if(kMaps.begin(), kMaps.end(),
                                [&](const MapName& m) { return name == QLatin1String(m.name); });
  if (map == kMaps.end()) return std::nullopt;
  look.map = map->map;
  for (std::size_t i = 0; i < kDrawings.size(); ++i)
    if (object["drawing"].toString() == QLatin1String(kDrawings[i]))
      look.drawing = static_cast<FlameDrawing>(i);
  look.exposure = std::clamp(object["exposure"].toDouble(), -kMostStops, kMostStops);
  look.automatic = object["automatic"].toBool(true);
  look.cold = object["cold"].toDouble();
  look.hot = object["hot"].toDouble();
  look.density = object["density"].toDouble();
  if (!(look.density > 0 && look.density <= kMostDensity)) return std::nullopt;
  if (!look.automatic && !(look.hot > look.cold && look.cold >= 0)) return std::nullopt;
  look.points.clear();
  for (const auto& value : object["points"].toArray()) {
    const QJsonArray pair = value.toArray();
    const OpacityPoint p{pair.at(0).toDouble(-1), pair.at(1).toDouble(-1)};
    if (!is_share(p.place) || !is_share(p.opacity)) return std::nullopt;
    if (!look.points.empty() && !(p.place > look.points.back().place)) return std::nullopt;
    look.points.push_back(p);
  }
  if (look.points.size() < 2 || look.points.front().place != 0 || look.points.back().place != 1)
    return std::nullopt;
  return look;
}

}  // namespace plenoflame::desktop
