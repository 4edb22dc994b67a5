#include "model/jobs/ray_selector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/math/ray_span.h"

namespace plenoflame::desktop {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

SelectedRays trace(const Selection& selection, std::shared_ptr<const CompiledScene> scene,
                   const Execution& execution) {
  SelectedRays out;
  out.selection = selection;
  out.scene = std::move(scene);
  out.paths = empty_ray_paths(*out.scene);
  RenderSettings settings;
  settings.seed = out.scene->scene.render.seed;
  settings.samples = RaySelector::kRaysPerPixel;
  std::set<std::pair<int, int>> pixels;
  switch (selection.kind) {
    case Selection::Kind::none:
      break;
    case Selection::Kind::pixel:
      add_pixel_rays(*out.scene, settings, {{selection.column, selection.row}}, execution,
                     out.paths);
      break;
    case Selection::Kind::microlens: {
      settings.samples = settings.replicates;
      add_microlens_rays(*out.scene, settings, selection.lens, execution, out.paths);
      for (const RayPath& ray : out.paths.rays) pixels.emplace(ray.column, ray.row);
      RaySelection most;
      most.most = RaySelector::kMostRays;
      select_rays(most, out.paths);
      break;
    }
    case Selection::Kind::point:
      add_object_rays(*out.scene, selection.point, RaySelector::kRaysPerPoint, out.paths);
      for (const RayPath& ray : out.paths.rays)
        if (ray.column >= 0) pixels.emplace(ray.column, ray.row);
      break;
  }
  for (const auto& [column, row] : pixels) out.pixels.push_back({column, row});
  return out;
}

/// The axis towards the scene.
Vec3 axis_of(const SelectedRays& rays) {
  return normalize(rays.scene->scene.camera.look_direction);
}

double angle_between(const SelectedRays& rays, Vec3 a, Vec3 b) {
  const Vec3 way = b - a, axis = axis_of(rays);
  return std::atan2(length(cross(way, axis)), std::fabs(dot(way, axis)));
}

}  // namespace

QString status_text(const RayPaths& paths, const TraceStatus& status) {
  const auto at = [&] {
    const auto surface = static_cast<std::size_t>(std::max(0, status.surface));
    return surface < paths.surfaces.size() ? QString::fromStdString(paths.surfaces[surface])
                                           : QObject::tr("a surface");
  };
  switch (status.status) {
    case RayStatus::reached:
      return QObject::tr("reached");
    case RayStatus::vignetted:
      return QObject::tr("vignetted at %1").arg(at());
    case RayStatus::total_internal_reflection:
      return QObject::tr("total reflection at %1").arg(at());
    case RayStatus::missed:
      return QObject::tr("missed %1").arg(at());
  }
  return {};
}

std::vector<RayRow> ray_rows(const SelectedRays& rays) {
  std::vector<RayRow> rows;
  const RayPaths& paths = rays.paths;
  const auto& types = rays.scene->scene.camera.array.types;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    RayRow row;
    row.ray = static_cast<int>(i);
    row.column = ray.column;
    row.row = ray.row;
    row.status = status_text(paths, ray.status);
    if (ray.type >= 0 && static_cast<std::size_t>(ray.type) < types.size())
      row.microlens =
          QString("%1 (%2, %3)")
              .arg(QString::fromStdString(types[static_cast<std::size_t>(ray.type)].name))
              .arg(ray.lens.q)
              .arg(ray.lens.r);
    row.angle = row.scene_angle = kNone;
    if (ray.count >= 2) {
      const RayVertex* const v = &paths.vertices[ray.first];
      const std::size_t last = ray.count - 1;
      const bool reversed = v[0].surface == kObjectVertex;
      const double first_angle = angle_between(rays, v[0].position, v[1].position);
      const double last_angle = angle_between(rays, v[last - 1].position, v[last].position);
      const bool through = ray.status.status == RayStatus::reached;
      if (!reversed) row.angle = first_angle;
      if (reversed && through) row.angle = last_angle;
      if (reversed) row.scene_angle = first_angle;
      if (!reversed && through) row.scene_angle = last_angle;
    }
    row.optical_thickness = ray.optical_thickness;
    row.radiance = paths.radiance_of(i, 0);
    row.weight = ray.weight;
    rows.push_back(row);
  }
  return rows;
}

std::vector<RaySurfaceRow> ray_surfaces(const SelectedRays& rays, std::size_t ray) {
  std::vector<RaySurfaceRow> rows;
  const RayPaths& paths = rays.paths;
  if (ray >= paths.rays.size()) return rows;
  const RayPath& path = paths.rays[ray];
  const Vec3 origin = rays.scene->scene.camera.position, axis = axis_of(rays);
  for (std::size_t i = 0; i < path.count; ++i) {
    const RayVertex& vertex = paths.vertices[path.first + i];
    RaySurfaceRow row;
    if (vertex.surface >= 0 && static_cast<std::size_t>(vertex.surface) < paths.surfaces.size())
      row.surface =
          QString::fromStdString(paths.surfaces[static_cast<std::size_t>(vertex.surface)]);
    else if (vertex.surface == kSensorVertex)
      row.surface = QObject::tr("sensor");
    else if (vertex.surface == kObjectVertex)
      row.surface = QObject::tr("object point");
    else if (vertex.surface == kSolidVertex)
      row.surface = QObject::tr("solid surface");
    else
      row.surface = QObject::tr("scene");
    row.distance = vertex.distance;
    row.height = length(cross(vertex.position - origin, axis));
    row.index = vertex.index;
    row.angle = i + 1 < path.count ? angle_between(rays, vertex.position,
                                                   paths.vertices[path.first + i + 1].position)
                                   : kNone;
    rows.push_back(row);
  }
  return rows;
}

LensIndex microlens_of_pixel(const Camera& camera, int column, int row) {
  const Vec2 point = camera.sensor_point(column + 0.5, row + 0.5);
  const MicrolensLattice& lattice = camera.lattice();
  // On the line from the pixel to the middle of the exit pupil, or a neighbour of it.
  const LensIndex straight = lattice.nearest(point);
  const double pupil = camera.exit_pupil();
  const double share = std::isfinite(pupil)
                           ? (pupil - camera.lens_place(straight).z) / (pupil - camera.sensor())
                           : 1.0;
  const Vec2 middle = camera.foot() + share * (point - camera.foot());
  const double reach = 1.5 * longest_pitch(camera.spec().array);
  LensIndex best = lattice.nearest(middle);
  double least = std::numeric_limits<double>::infinity();
  for (const LensIndex lens :
       lattice.within(middle - Vec2{reach, reach}, middle + Vec2{reach, reach})) {
    const auto at = camera.at_stop(point, lens);
    if (!at || !(length(*at) < least)) continue;
    least = length(*at);
    best = lens;
  }
  return best;
}

QString place_text(const CompiledScene& scene, const Vec3& world) {
  const auto text = [](double value, Dimension dimension) {
    return QString::fromStdString(readable_quantity(value, dimension, 3));
  };
  const Vec3 p = scene.camera.to_world().inverse().point(world);
  QString out =
      QObject::tr("%1 %2, %3 beside, %4 %5")
          .arg(text(std::fabs(p.z), Dimension::length),
               p.z < 0 ? QObject::tr("behind") : QObject::tr("in front"),
               text(std::fabs(p.x), Dimension::length), text(std::fabs(p.y), Dimension::length),
               p.y > 0 ? QObject::tr("below") : QObject::tr("above"));
  if (!scene.medium) return out;
  const Box box = scene.medium->bounds();
  if (world.x < box.lower.x || world.y < box.lower.y || world.z < box.lower.z ||
      world.x > box.upper.x || world.y > box.upper.y || world.z > box.upper.z)
    return out;
  const MediumSample here = scene.medium->sample(world);
  if (here.temperature > 0)
    out += QObject::tr("; %1, %2")
               .arg(text(here.temperature, Dimension::temperature),
                    text(here.absorption, Dimension::absorption));
  return out;
}

QString microlens_text(const CompiledScene& scene, LensIndex lens) {
  const auto type = static_cast<std::size_t>(scene.camera.lattice().type(lens));
  const auto& types = scene.scene.camera.array.types;
  return QObject::tr("microlens (%1, %2), %3")
      .arg(lens.q)
      .arg(lens.r)
      .arg(type < types.size() ? QString::fromStdString(types[type].name) : QString());
}

bool flame_point(const Medium& medium, const Ray& ray, Vec3& point) {
  const auto [near, far] =
      clip_to_box(medium.bounds(), ray, 0, std::numeric_limits<double>::infinity());
  if (!(near < far)) return false;
  constexpr int kSteps = 400;
  const double step = (far - near) / kSteps, length_step = step * length(ray.direction);
  std::vector<double> emission(static_cast<std::size_t>(medium.channel_count()));
  double most = 0, thickness = 0;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 p = ray.origin + (near + (i + 0.5) * step) * ray.direction;
    const double kappa = medium.coefficients(p, emission.data());
    thickness += 0.5 * kappa * length_step;
    const double light = emission[0] * std::exp(-thickness);
    thickness += 0.5 * kappa * length_step;
    if (light > most) {
      most = light;
      point = p;
    }
  }
  return most > 0;
}

RaySelector::RaySelector(Document& document, SceneCompiler& compiler, QObject* parent)
    : QObject(parent), document_(document), compiler_(compiler) {
  connect(&document_, &Document::selection_changed, this, &RaySelector::request);
  connect(&compiler_, &SceneCompiler::cleared, this, &RaySelector::request);
  connect(&compiler_, &SceneCompiler::compiled_changed, this, [this](const SceneChanges& changes) {
    if (changes.compiled() || !rays_) request();
  });
}

void RaySelector::request() {
  const unsigned number = ++newest_;
  const Selection selection = document_.selection();
  const auto scene = compiler_.compiled();
  if (selection.kind == Selection::Kind::none || !scene) {
    task_.cancel();
    done_ = number;
    if (rays_) {
      rays_ = nullptr;
      emit rays_changed();
    }
    return;
  }
  task_.request([this, selection, scene, number](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      auto rays = std::make_shared<const SelectedRays>(trace(selection, scene, execution));
      post(this, [this, rays, number] {
        if (number != newest_) return;
        done_ = number;
        rays_ = rays;
        emit rays_changed();
      });
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      const std::string message = error.what();
      post(this, [this, message, number] {
        if (number != newest_) return;
        done_ = number;
        rays_ = nullptr;
        emit rays_changed();
        emit failed(QString::fromStdString(message));
      });
    }
  });
}

}  // namespace plenoflame::desktop
