#include "widgets/window/compare_window.h"

#include <QGridLayout>
#include <QLabel>
#include <QScreen>
#include <QVBoxLayout>
#include <algorithm>
#include <string>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "widgets/controls/theme.h"
#include "widgets/image/colour_bar.h"
#include "widgets/image/image_view.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view.h"

namespace plenoflame::desktop {
CompareWindow::CompareWindow(Session& mine, const ToneSettings& tone, QWidget* parent)
    : QDialog(parent), sessions_{&mine, &own_}, tone_(tone) {
  setObjectName("compareWindow");
  setWindowTitle(tr("Two scenes side by side"));
  auto* grid = new QGridLayout(this);
  for (const std::size_t side : {0U, 1U}) {
    Session& session = *sessions_[side];
    titles_[side] = new QLabel(this);
    titles_[side]->setObjectName(side == 0 ? "compareTitleLeft" : "compareTitleRight");
    scenes_[side] = new SceneView(this);
    images_[side] = new ImageView(this);
    images_[side]->setObjectName(side == 0 ? "compareLeft" : "compareRight");
    images_[side]->set_value_format(Dimension::flux);
    bars_[side] = new ColourBar(this);
    const int column = 2 * static_cast<int>(side);
    grid->addWidget(titles_[side], 0, column, 1, 2);
    grid->addWidget(scenes_[side], 1, column, 1, 2);
    grid->addWidget(images_[side], 2, column);
    grid->addWidget(bars_[side], 2, column + 1);
    grid->setColumnStretch(column, 1);
    connect(&session.document(), &Document::image_changed, this, [this, side] { fill(side); });
    connect(&session.compiler(), &SceneCompiler::compiled_changed, this,
            [this, side](const SceneChanges& changes) {
              scenes_[side]->set_scene(sessions_[side]->compiler().compiled(), changes);
              fill(side);
            });
    connect(&session.compiler(), &SceneCompiler::failed, this,
            [this, side](const QString& message) { scenes_[side]->set_notice(message); });
    connect(&session.rays(), &RaySelector::rays_changed, this,
            [this, side] { scenes_[side]->set_rays(sessions_[side]->rays().rays()); });
    // A selection in one is one in both.
    connect(images_[side], &ImageView::pixel_clicked, this, [this](int column_at, int row_at) {
      for (Session* each : sessions_)
        each->document().select(Selection::of_pixel(column_at, row_at));
    });
    connect(&session.document(), &Document::selection_changed, this, [this, side] {
      const Selection& now = sessions_[side]->document().selection();
      sessions_[1 - side]->document().select(now);
      images_[side]->set_selected_pixel(now.kind == Selection::Kind::pixel
                                            ? std::optional(Pixel{now.column, now.row})
                                            : std::nullopt);
    });
    connect(images_[side], &ImageView::view_changed, this, [this, side] { follow_view(side); });
    connect(scenes_[side], &SceneView::part_requested, this, [this](int part) {
      for (SceneView* each : scenes_) each->show_part(static_cast<SceneView::Part>(part));
    });
    connect(scenes_[side], &SceneView::look_edited, this, [this](const FlameLook& look) {
      for (SceneView* each : scenes_) each->set_flame_look(look);
    });
  }
  grid->setRowStretch(1, 2);
  grid->setRowStretch(2, 3);
  scenes_[1]->look_as(*scenes_[0]);
  resize(QSize(1200, 820).boundedTo(screen()->availableSize() * kShareOfScreen));
  if (mine.compiler().compiled())
    scenes_[0]->set_scene(mine.compiler().compiled(), SceneChanges::all());
  if (mine.rays().rays()) scenes_[0]->set_rays(mine.rays().rays());
  fill(0);
}

CompareWindow::~CompareWindow() {
  for (const std::size_t side : {0U, 1U}) {
    sessions_[side]->document().disconnect(this);
    sessions_[side]->compiler().disconnect(this);
    sessions_[side]->rays().disconnect(this);
  }
}

void CompareWindow::open(const QString& file) {
  own_.document().open(file.toStdString());
  own_.document().select(sessions_[0]->document().selection());
}

void CompareWindow::fill(std::size_t side) {
  const Document& document = sessions_[side]->document();
  titles_[side]->setText(QString::fromStdString(document.name()));
  const auto& field = document.image();
  if (!field || field->channels.empty()) {
    tasks_[side].cancel();
    images_[side]->set_image(nullptr);
    return scenes_[side]->set_picture(nullptr);
  }
  titles_[side]->setText(
      tr("%1: %2 of %3")
          .arg(titles_[side]->text(), QString::fromStdString(field->channels[0].name))
          .arg(field->samples, 0, 'g', 4) +
      tr(" rays"));
  tasks_[side].request([this, side, field](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      const auto picture = std::make_shared<const ImagePyramid>(
          std::shared_ptr<const Image>(field, &field->channels[0].flux), execution);
      post(this, [=, this, on_sensor = picture_on_sensor(*picture)] {
        if (field != sessions_[side]->document().image()) return;
        images_[side]->set_image(picture);
        scenes_[side]->set_picture(on_sensor);
        set_tones();
      });
    } catch (const std::exception&) {  // stopped: a newer picture follows
    }
  });
}

/// One scale for both, so that brighter is brighter: of irradiance, as a larger pixel gets more.
void CompareWindow::set_tones() {
  white_ = 0;
  std::array<double, 2> brightest{}, area{};
  std::array<std::string, 2> light;
  for (const std::size_t side : {0U, 1U}) {
    const ImageView& view = *images_[side];
    const auto& field = sessions_[side]->document().image();
    if (!field || field->channels.empty() || !view.image() || view.image()->empty()) continue;
    const Vec2 pixel = sessions_[side]->document().camera().sensor.pixel();
    area[side] = pixel.x * pixel.y;
    light[side] = field->channels[0].name;
    // The level of some hundred pixels knows no single bright ones.
    const Image& coarse = view.image()->level(view.image()->level_within(256));
    for (const float value : coarse.pixels)
      brightest[side] = std::max(brightest[side], static_cast<double>(value));
  }
  if (light[0] == light[1])
    for (const std::size_t side : {0U, 1U})
      if (area[side] > 0) white_ = std::max(white_, brightest[side] / area[side]);
  for (const std::size_t side : {0U, 1U}) {
    ToneSettings tone = tone_;
    tone.white = white_ > 0 ? white_ * area[side] : brightest[side];
    if (!(tone.white > 0)) tone.white = 1;
    images_[side]->set_tone(tone);
    bars_[side]->set_tone(tone, Dimension::flux);
  }
}

void CompareWindow::set_map(ColourMap map) {
  tone_.map = map;
  set_tones();
}

void CompareWindow::follow_view(std::size_t side) {
  if (following_) return;
  ImageView &from = *images_[side], &to = *images_[1 - side];
  if (!from.image() || !to.image() || from.image()->empty() || to.image()->empty()) return;
  following_ = true;
  // The same part of both sensors, however many pixels they have.
  const double ratio = static_cast<double>(to.image()->width()) / from.image()->width();
  to.set_scale(from.scale() / ratio);
  to.centre_on(from.centre().x() * ratio,
               from.centre().y() * to.image()->height() / from.image()->height());
  following_ = false;
}

}  // namespace plenoflame::desktop
