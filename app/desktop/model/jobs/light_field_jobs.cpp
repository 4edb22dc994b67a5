#include "model/jobs/light_field_jobs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame::desktop {

Image shift_and_add(const Views& views, const ViewGeometry& geometry, double depth) {
  if (views.views.empty()) return {};
  const Image& first = views.views.front().image;
  Image sum(first.width, first.height), weight(first.width, first.height);
  for (const View& view : views.views) {
    // Things at the depth stand this much to the side of where the middle view has it. Points
    // nearer than the focus move against the viewpoint.
    const double x = -geometry.disparity(depth, view.offset.x),
                 y = -geometry.disparity(depth, view.offset.y);
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    const double x_floor = std::floor(x), y_floor = std::floor(y);
    const auto a = static_cast<float>(x - x_floor), b = static_cast<float>(y - y_floor);
    const int dx = static_cast<int>(x_floor), dy = static_cast<int>(y_floor);
    const float w00 = (1 - a) * (1 - b), w10 = a * (1 - b), w01 = (1 - a) * b, w11 = a * b;
    const int row_end = std::min(first.height, first.height - 1 - dy),
              column_end = std::min(first.width, first.width - 1 - dx);
    for (int row = std::max(0, -dy); row < row_end; ++row)
      for (int column = std::max(0, -dx); column < column_end; ++column) {
        const float p00 = view.image.at(column + dx, row + dy),
                    p10 = view.image.at(column + dx + 1, row + dy),
                    p01 = view.image.at(column + dx, row + dy + 1),
                    p11 = view.image.at(column + dx + 1, row + dy + 1);
        sum.at(column, row) += w00 * p00 + w10 * p10 + w01 * p01 + w11 * p11;
        weight.at(column, row) += 1;
      }
  }
  for (std::size_t i = 0; i < sum.pixels.size(); ++i)
    if (weight.pixels[i] > 0) sum.pixels[i] /= weight.pixels[i];
  return sum;
}

LightFieldJobs::LightFieldJobs(QObject* parent)
    : QObject(parent),
      micro_task_(std::make_unique<LatestTask>(Urgency::in_reserve)),
      views_task_(std::make_unique<LatestTask>(Urgency::in_reserve)),
      refocus_(std::make_unique<LatestTask>(Urgency::waited_for)),
      stack_task_(std::make_unique<LatestTask>(Urgency::work)) {}

LightFieldJobs::~LightFieldJobs() {
  // Stops all before waiting for the first.
  micro_task_->cancel();
  views_task_->cancel();
  refocus_->cancel();
  stack_task_->cancel();
}

/// Runs function(execution) and tells about what it throws.
template <class Function>
void LightFieldJobs::run(LatestTask& task, Function function) {
  task.request([this, function](std::stop_token stop) {
    Execution execution;
    execution.stop = stop;
    try {
      function(execution);
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      const std::string message = error.what();
      if (!stop.stop_requested())
        post(this, [this, message] { emit failed(QString::fromStdString(message)); });
    }
  });
}

void LightFieldJobs::clear() {
  views_task_->cancel();
  refocus_->cancel();
  stack_task_->cancel();
  ++image_number_;
  field_ = nullptr;
  views_ = nullptr;
  geometry_.reset();
  refocused_ = {};
  stack_ = nullptr;
  emit views_changed();
}

void LightFieldJobs::set_camera(const CameraSpec& camera, const std::vector<WindowSpec>& windows) {
  if (is_of(camera, windows)) return;
  clear();
  camera_ = camera;
  windows_ = windows;
  if (view_type_ >= static_cast<int>(camera.array.types.size())) view_type_ = -1;
  outlines_ = micro_images_ = nullptr;
  white_begun_ = false;
  if (!camera.array.present) {
    micro_task_->cancel();
    emit outlines_changed();
    emit views_changed();
    return;
  }
  run(*micro_task_, [this, camera, windows](const Execution& execution) {
    auto outlines = std::make_shared<const MicroImages>(Camera(camera), false, execution);
    post(this, [this, camera, windows, outlines] {
      if (!is_of(camera, windows)) return;
      outlines_ = outlines;
      emit outlines_changed();
      find_white();
    });
  });
}

void LightFieldJobs::find_white() {
  if (!outlines_ || !field_ || white_begun_) return;
  white_begun_ = true;
  run(*micro_task_, [this, camera = *camera_, windows = windows_](const Execution& execution) {
    auto micro = std::make_shared<MicroImages>(Camera(camera), true, execution);
    micro->look_through(windows);
    post(this, [this, camera, windows, micro] {
      if (!is_of(camera, windows)) return;
      micro_images_ = micro;
      make_views();
    });
  });
}

void LightFieldJobs::set_image(std::shared_ptr<const LightField> field, const CameraSpec& camera,
                               const std::vector<WindowSpec>& windows, bool other_scene) {
  set_camera(camera, windows);
  if (!camera.array.present || field == field_) return;
  field_ = std::move(field);
  ++image_number_;
  if (other_scene) {
    refocus_->cancel();
    stack_task_->cancel();
    refocused_ = {};
    stack_ = nullptr;
  }
  find_white();
  make_views();
}

void LightFieldJobs::set_view_type(int type) {
  if (type == view_type_) return;
  view_type_ = type;
  make_views();
}

void LightFieldJobs::make_views() {
  if (!micro_images_ || !field_) return;
  const unsigned number = image_number_;
  run(*views_task_, [this, number, field = field_, micro = micro_images_,
                     type = view_type_](const Execution& execution) {
    ViewSettings settings;
    settings.grid = kGrid;
    settings.type = type;
    auto views = std::make_shared<const Views>(extract_views(*field, *micro, settings, execution));
    const ViewGeometry geometry = fit_view_geometry(*micro, views->lens_step);
    post(this, [this, number, views, geometry] {
      if (number != image_number_) return;
      views_ = views;
      geometry_ = geometry;
      emit views_changed();
      if (wanted_refocus_) refocus(wanted_refocus_->first, wanted_refocus_->second);
    });
  });
}

void LightFieldJobs::refocus(double depth, double aperture) {
  wanted_refocus_ = {depth, aperture};
  if (!micro_images_ || !field_ || !views_) return;
  const unsigned number = image_number_;
  run(*refocus_, [this, number, depth, aperture, field = field_, micro = micro_images_,
                  views = views_, geometry = geometry_](const Execution& execution) {
    check_refocus_depth(micro->camera(), depth);
    const auto show = [&](Image image, bool preview) {
      auto shared = std::make_shared<const Image>(std::move(image));
      post(this, [this, number, shared, depth, preview, stop = execution.stop] {
        if (number != image_number_ || (stop.stop_requested() && !preview)) return;
        refocused_ = {shared, preview, depth};
        emit refocused_changed();
      });
    };
    if (geometry) show(shift_and_add(*views, *geometry, depth), true);
    RefocusSettings settings;
    settings.depth = depth;
    settings.aperture = aperture;
    if (execution.stop.stop_requested()) return;
    show(plenoflame::refocus(*field, *micro, settings, execution).image, false);
  });
}

void LightFieldJobs::total_focus(double nearest, double farthest, int planes) {
  if (!micro_images_ || !field_) return;
  const unsigned number = image_number_;
  run(*stack_task_, [this, number, nearest, farthest, planes, field = field_,
                     micro = micro_images_](const Execution& execution) {
    std::vector<double> depths;  // equal steps of 1 / depth, as disparity goes
    for (int i = 0; i < planes; ++i) {
      const double t = static_cast<double>(i) / (planes - 1);
      depths.push_back(1 / ((1 - t) / nearest + t / farthest));
    }
    auto stack =
        std::make_shared<const FocusStack>(focus_stack(*field, *micro, depths, {}, execution));
    post(this, [this, number, stack] {
      if (number != image_number_) return;
      stack_ = stack;
      emit stack_changed();
    });
  });
}

}  // namespace plenoflame::desktop
