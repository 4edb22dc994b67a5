#include <QAction>
#include <QLabel>
#include <QStatusBar>
#include <QToolButton>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "plenoflame/base/units.h"
#include "widgets/controls/side_panel.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/rays_panel.h"
#include "widgets/panels/render_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "widgets/window/main_window.h"

// The window follows the session, and the session what is selected in the window.
namespace plenoflame::desktop {
namespace {

constexpr int kReadAgainAfter = 250;  ///< [ms] after the last of several edits in a row

}  // namespace

void MainWindow::connect_session() {
  Document& document = session_.document();
  connect(&document, &Document::state_changed, this, &MainWindow::update_title);
  // Mistakes of the scene before are none of this one's, and what is mended is over.
  const auto forget_failure = [this] {
    if (!standing_failure_.isEmpty() && statusBar()->currentMessage() == standing_failure_)
      statusBar()->clearMessage();
    standing_failure_.clear();
  };
  connect(&document, &Document::state_changed, this, forget_failure);
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this, forget_failure);
  // Outlines are of the camera that took the picture: while that is an older one there are none.
  const auto taken_by_another = std::make_shared<bool>(false);
  const auto show_outlines = [this, taken_by_another] {
    const bool wanted = image_->outlines_action()->isChecked() && !*taken_by_another;
    image_->view().set_micro_images(wanted ? session_.light_field().outlines() : nullptr);
  };
  connect(&document, &Document::scene_changed, this, [=, &document](const SceneChanges& changes) {
    if (changes.camera) *taken_by_another = document.image() != nullptr;
    show_outlines();
  });
  connect(&document, &Document::image_changed, this, [=] {
    *taken_by_another = false;
    show_outlines();
  });
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this,
          [this](const SceneChanges& changes) {
            const auto& scene = session_.compiler().compiled();
            std::vector<CameraSpec> others;
            for (const CameraSpec& camera : session_.document().scene().cameras)
              if (camera.name != scene->scene.camera.name) others.push_back(camera);
            scene_view_->set_scene(scene, changes, std::move(others));
            section_->set_scene(scene);
          });
  connect(&session_.compiler(), &SceneCompiler::cleared, this, [this] {
    scene_view_->clear();
    section_->set_scene(nullptr);
    image_->view().set_micro_images(nullptr);
  });
  connect(&session_.rays(), &RaySelector::rays_changed, this, [this] {
    const auto& rays = session_.rays().rays();
    scene_view_->set_rays(rays, rays_->chosen());
    section_->set_rays(rays, rays_->chosen());
    image_->view().set_marks(rays ? rays->pixels : std::vector<Pixel>{});
  });
  connect(image_, &ImagePanel::pyramid_changed, this, [this] {
    scene_view_->set_picture(image_->on_sensor());
    show_state();  // the picture of the scene before is gone
  });
  connect(image_, &ImagePanel::map_changed, light_field_, &LightFieldPanel::set_map);
  measured_later_.setSingleShot(true);
  measured_later_.setInterval(kReadAgainAfter);
  connect(&measured_later_, &QTimer::timeout, this, &MainWindow::renew_measured);
  connect(&session_.measured(), &MeasuredPicture::outdated, this,
          [this] { measured_later_.start(); });
  connect(&session_, &Session::failed, this, [this](const QString& what, const QString& message) {
    last_message_ = message;
    standing_failure_ = what + ": " + message;
    statusBar()->showMessage(standing_failure_);
  });
  connect(&session_, &Session::warned, this, [this](const QString& message) {
    statusBar()->showMessage(tr("warning: ") + message, 15000);
  });
  connect(&session_.light_field(), &LightFieldJobs::outlines_changed, this, show_outlines);
  connect(image_->outlines_action(), &QAction::toggled, this, [=, this](bool on) {
    if (on) session_.set_outlines_wanted(true);
    show_outlines();
  });
  const auto show = [this] { show_state(); };
  connect(&session_.render(), &RenderJob::progressed, this, show);
  connect(&session_.render(), &RenderJob::state_changed, this, show);
  connect(&document, &Document::scene_changed, this, show);
  connect(&document, &Document::image_changed, this, show);
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this, show);
  connect(&session_.compiler(), &SceneCompiler::failed, this, show);
  connect(&session_.light_field(), &LightFieldJobs::views_changed, this, show);
}

/// Says what is going on, and of every view whether it shows the scene as it is.
void MainWindow::show_state() {
  const RenderJob& job = session_.render();
  const bool running = job.state() == RenderJob::State::running;
  const Document& shown = session_.document();
  const QString& failure = session_.compiler().failure();
  const bool compiling = !shown.is_empty() && shown.is_valid() && failure.isEmpty() &&
                         !session_.compiler().is_current();
  const bool gone = !session_.compiler().compiled();
  if (gone && !failure.isEmpty()) image_->drop_left_over();
  const bool old = shown.image() && !shown.image_is_current();
  QStringList said{running     ? tr("rendering, %1 %").arg(100 * job.status().fraction, 0, 'f', 0)
                   : compiling ? tr("preparing the scene")
                   : !failure.isEmpty() ? tr("the scene has an error")
                   : old ? tr("the picture is older than the last change; F5 renders")
                         : QString(),
                   render_->brief()};
  said.removeAll(QString());
  status_line_->setText(said.join(", "));
  status_line_->setVisible(!said.isEmpty());
  const QString notice = failure.isEmpty() ? QString()
                         : gone            ? failure
                                           : tr("As before the last change: ") + failure;
  show_pixel_of_picture();
  scene_view_->set_notice(notice);
  section_->set_notice(notice);
  image_->view().set_badge(image_->is_left_over() ? tr("of the scene before")
                           : old                  ? tr("older than the last change")
                                                  : QString());
  image_->view().set_empty_text(failure.isEmpty() ? QString() : failure);
  light_field_->set_notice(gone && !failure.isEmpty() ? failure : QString(),
                           session_.views_are_old());
}

/// Beside the flux that the selected pixel's rays add up to stands the one that the picture has.
void MainWindow::show_pixel_of_picture() {
  const Selection& selection = session_.document().selection();
  const auto& field = session_.document().image();
  if (selection.kind != Selection::Kind::pixel || !field || !session_.document().image_is_current())
    return rays_->set_pixel_of_picture({});
  const QString said = image_->flux_text(selection.column, selection.row);
  rays_->set_pixel_of_picture(
      said.isEmpty()
          ? QString()
          : tr("in the picture, of %1 rays per microlens: %2").arg(field->samples).arg(said));
}

void MainWindow::connect_selection() {
  Document& document = session_.document();
  const auto select_pixel = [this](int column, int row) {
    session_.document().select(Selection::of_pixel(column, row));
  };
  const auto select_lens = [this](const LensIndex& lens) {
    session_.document().select(Selection::of_microlens(lens));
  };
  const auto select_point = [this](const Vec3& point) {
    session_.document().select(Selection::of_point(point));
  };
  ImageView& view = image_->view();
  connect(&view, &ImageView::pixel_clicked, this, select_pixel);
  connect(&view, &ImageView::lens_clicked, this, &MainWindow::select_lens_at);
  connect(&view, &ImageView::hovered, this, [this](int column, int row, double) {
    pointer_label_->setText(column < 0 ? QString() : image_->describe(column, row));
  });
  connect(section_, &SectionView::pointed, pointer_label_, &QLabel::setText);
  connect(scene_view_, &SceneView::pointed, this, &MainWindow::show_pointed);
  connect(scene_view_, &SceneView::pixel_picked, this, select_pixel);
  connect(scene_view_, &SceneView::lens_picked, this, select_lens);
  connect(scene_view_, &SceneView::point_picked, this, select_point);
  connect(scene_view_, &SceneView::measured_changed, this, [this](double distance) {
    if (!(distance > 0)) return statusBar()->clearMessage();
    statusBar()->showMessage(
        tr("distance %1")
            .arg(QString::fromStdString(readable_quantity(distance, Dimension::length, 4))));
  });
  connect(scene_view_, &SceneView::part_requested, this, &MainWindow::show_part);
  connect(scene_view_, &SceneView::look_edited, this,
          [this](const FlameLook& look, const QString& what) {
            session_.document().set_look(look, what.toStdString());
          });
  connect(scene_view_, &SceneView::moved, this, &MainWindow::move_thing);
  connect(scene_view_, &SceneView::picture_requested, this, &MainWindow::export_picture_of_scene);
  connect(rays_, &RaysPanel::pixel_requested, this, select_pixel);
  connect(section_, &SectionView::lens_clicked, this, select_lens);
  connect(section_, &SectionView::point_clicked, this, select_point);
  connect(&document, &Document::selection_changed, this, &MainWindow::show_selection);
}

/// A flame, or the chosen camera, goes where its handle was dragged.
void MainWindow::move_thing(int flame, const Vec3& position, int stroke) {
  Document& document = session_.document();
  Scene scene = document.scene();
  const auto number = static_cast<std::size_t>(std::max(0, flame));
  if (flame >= 0) {
    if (number >= scene.flames.size()) return;
    scene.flames[number].position = position;
  } else if (scene.cameras.empty()) {
    scene.camera.position = position;
  } else {
    for (CameraSpec& camera : scene.cameras)
      if (camera.name == document.camera_name()) camera.position = position;
  }
  const QString what = flame >= 0 ? tr("move of the flame") : tr("move of the camera");
  guarded([&] { document.change(scene, what.toStdString(), "drag " + std::to_string(stroke)); });
}

void MainWindow::select_lens_at(int column, int row) {
  const auto& scene = session_.compiler().compiled();
  if (!scene || !scene->camera.has_array()) return;
  const LensIndex lens = microlens_of_pixel(scene->camera, column, row);
  session_.document().select(Selection::of_microlens(lens));
}

void MainWindow::show_pointed(const Selection& target) {
  const auto& scene = session_.compiler().compiled();
  QString text;
  if (scene && target.kind == Selection::Kind::pixel)
    text = image_->describe(target.column, target.row);
  if (scene && target.kind == Selection::Kind::microlens)
    text = microlens_text(*scene, target.lens);
  if (scene && target.kind == Selection::Kind::point) text = place_text(*scene, target.point);
  pointer_label_->setText(text);
}

void MainWindow::show_selection() {
  const Selection& selection = session_.document().selection();
  ImageView& view = image_->view();
  view.set_selected_pixel(selection.kind == Selection::Kind::pixel
                              ? std::optional(Pixel{selection.column, selection.row})
                              : std::nullopt);
  show_pixel_of_picture();
  view.set_selected_lens(
      selection.kind == Selection::Kind::microlens ? std::optional(selection.lens) : std::nullopt);
  // Somebody who closed the table while something was selected does not want it.
  const bool selected = selection.kind != Selection::Kind::none;
  if (selected && !had_selection_) side_->open("raysGroup");
  had_selection_ = selected;
}

}  // namespace plenoflame::desktop
