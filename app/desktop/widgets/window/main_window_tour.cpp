#include <QAction>
#include <QComboBox>
#include <QLineEdit>
#include <QTreeView>
#include <QVBoxLayout>
#include <array>
#include <memory>
#include <vector>

#include "plenoflame/base/units.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "widgets/window/compare_window.h"
#include "widgets/window/film_dialog.h"
#include "widgets/window/main_window.h"
#include "widgets/window/tour_dialog.h"

// Tools of a lecture: the guided tour, films, one type of microlens after the other.
namespace plenoflame::desktop {
namespace {

/// The brightest pixel of the picture, whose rays have something to show.
Pixel brightest_pixel(const LightField& field) {
  Pixel best{0, 0};
  const Image& flux = field.channels[0].flux;
  for (int row = 0; row < flux.height; ++row)
    for (int column = 0; column < flux.width; ++column)
      if (flux.at(column, row) > flux.at(best.column, best.row)) best = {column, row};
  return best;
}

}  // namespace

void MainWindow::start_tour() {
  if (!open_example("paper-previous-60x60")) return;
  using Part = SceneView::Part;
  const auto part = [this](Part which) { show_part(static_cast<int>(which)); };
  Document& document = session_.document();
  const auto pick_brightest = [this, &document] {
    if (!document.image()) return;
    const Pixel pixel = brightest_pixel(*document.image());
    document.select(Selection::of_pixel(pixel.column, pixel.row));
  };
  const auto show_whole_image = [this, &document] {
    light_field_->show_tab(LightFieldPanel::Tab::raw);
    document.select({});
    image_->outlines_action()->setChecked(false);
    image_->view().fit();
  };
  std::vector<TourDialog::Step> steps{
      {tr("A flame before a camera"),
       tr("In 3-D a flame stands one metre before a camera; Section shows both from the side. The "
          "picture on the right is what the sensor gets: it is being rendered by rays from every "
          "pixel."),
       [=] {
         show_whole_image();
         part(Part::scene);
       }},
      {tr("The flame"),
       tr("Soot glows by its temperature; the colours tell kelvins. Every place also absorbs, so "
          "that what is behind is seen weakened. A picture holds the sum along each ray."),
       [=] {
         show_whole_image();
         part(Part::flame);
       }},
      {tr("The main lens"),
       tr("The lens forms an image of the flame near the array of microlenses. A usual camera has "
          "its sensor there, and forgets from which part of the lens light came."),
       [=] {
         show_whole_image();
         part(Part::camera);
       }},
      {tr("The microlenses"),
       tr("Each microlens images the opening of the main lens on the pixels behind it. Which pixel "
          "is lit says from which part of the lens the light came: its direction."),
       [=] {
         show_whole_image();
         part(Part::array);
       }},
      {tr("The raw picture"),
       tr("From afar it looks like a usual picture. Its outlines show the image behind each "
          "microlens."),
       [=, this] {
         show_whole_image();
         image_->outlines_action()->setChecked(true);
       }},
      {tr("Close to it"),
       tr("Each disc is the same opening of the main lens, seen from another place of the array. "
          "Where in the disc a pixel is, is the direction; which disc, the place."),
       [=, this, &document] {
         show_whole_image();
         image_->outlines_action()->setChecked(true);
         if (!document.image()) return;
         const Pixel pixel = brightest_pixel(*document.image());
         image_->view().set_scale(12);
         image_->view().centre_on(pixel.column, pixel.row);
       }},
      {tr("One pixel, its rays"),
       tr("A click on a pixel shows the rays that it gets: a thin bundle through one part of the "
          "main lens, and a thin way through the flame. The table on the left has them one by "
          "one."),
       [=, this] {
         image_->outlines_action()->setChecked(false);
         image_->view().fit();
         pick_brightest();
         part(Part::scene);
       }},
      {tr("One point of the flame, its pixels"),
       tr("The light of one point meets many pixels under many microlenses, each from another "
          "direction: the flame is seen from slightly different places at once."),
       [=, this, &document] {
         image_->view().fit();
         const auto& compiled = session_.compiler().compiled();
         if (compiled && compiled->medium) {
           const Box box = compiled->medium->bounds();
           document.select(Selection::of_point(0.5 * (box.lower + box.upper)));
         }
         part(Part::camera);
       }},
      {tr("Views"),
       tr("The same pixel of every disc together is a picture through one part of the main lens. "
          "Drag the point in the opening: the flame moves as it would for an eye that moves."),
       [=, this] {
         show_whole_image();
         light_field_->show_tab(LightFieldPanel::Tab::views);
         part(Part::scene);
       }},
      {tr("Refocusing"),
       tr("Views that are shifted and added are a picture focused elsewhere, after it was taken. "
          "Drag the depth. From several directions, or several cameras, the flame itself can be "
          "found: Render > Reconstruct the flame."),
       [=, this] {
         show_whole_image();
         light_field_->show_tab(LightFieldPanel::Tab::refocus);
       }}};
  auto* const tour = new TourDialog(std::move(steps), this);
  tour->setAttribute(Qt::WA_DeleteOnClose);
  // Below everything that it speaks of.
  tour->setWindowFlags(Qt::Widget);
  workspace_->addWidget(tour);
  tour->show();
  tour->go_to(0);
}

void MainWindow::make_film() {
  if (session_.document().is_empty()) return fail(tr("There is no scene yet."));
  auto* const film = new FilmDialog(
      session_.document(),
      {{tr("the picture"), [this] { return image_->view().drawn(); }},
       {tr("the 3-D view"), [this] { return scene_view_->picture(); }, true},
       {tr("the section"), [this] { return section_->grab().toImage(); }},
       {tr("the window"),
        [this] {
          scene_view_->picture();
          return grab().toImage();
        },
        true}},
      [this] { return is_settled() && session_.document().image_is_current(); }, chooser_, this);
  film->setAttribute(Qt::WA_DeleteOnClose);
  connect(film, &FilmDialog::failed, this, [this](const QString& message) {
    last_message_ = message;  // the dialog says it, too
  });
  auto* const white = image_->findChild<QLineEdit*>("white");
  const auto set_white = [white](const QString& text) {
    white->setText(text);
    emit white->editingFinished();
  };
  const auto white_is_typed = std::make_shared<bool>(false);
  // Intermediate pictures are not filmed and would only take time. So would the 3-D view while
  // another one is filmed.
  connect(film, &FilmDialog::began, this, [=, this](bool space) {
    session_.render().set_finished_only(true);
    scene_view_->hold(!space);
    // One scale of brightness in all pictures, so that what gets darker is seen to. The value that
    // is white stands in its field meanwhile, where somebody may have typed one.
    const bool is_flux = image_->findChild<QComboBox*>("quantity")->currentIndex() == 0;
    if (white->text().isEmpty() && is_flux && session_.document().image())
      set_white(QString::fromStdString(
          format_quantity(image_->view().tone_settings().white, Dimension::flux)));
    else
      *white_is_typed = true;
  });
  connect(film, &FilmDialog::ended, this, [=, this] {
    session_.render().set_finished_only(false);
    scene_view_->hold(false);
    if (!*white_is_typed) set_white({});
    *white_is_typed = false;
  });
  const QModelIndex chosen = scene_->tree().currentIndex();
  film->set_parameter(chosen.data(ParameterModel::kPathRole).toString());
  film->show();
}

void MainWindow::compare_with(const QString& file) {
  if (session_.document().is_empty()) return fail(tr("There is no scene yet."));
  ToneSettings tone = image_->view().tone_settings();
  tone.is_signed = false;
  tone.saturation = 0;
  auto window = std::make_unique<CompareWindow>(session_, tone, this);
  if (!guarded([&] { window->open(file); })) return;
  window->setAttribute(Qt::WA_DeleteOnClose);
  connect(image_, &ImagePanel::map_changed, window.get(), &CompareWindow::set_map);
  window.release()->show();
}

/// From the middle of the array outwards: the first microlens of the type after that of the present
/// one.
void MainWindow::select_next_type() {
  const auto& scene = session_.compiler().compiled();
  if (!scene || !scene->camera.has_array()) return fail(tr("This camera has no microlenses."));
  const MicrolensLattice& lattice = scene->camera.lattice();
  const int types = static_cast<int>(scene->camera.microlenses().size());
  const Selection& now = session_.document().selection();
  const int wanted =
      now.kind == Selection::Kind::microlens ? (lattice.type(now.lens) + 1) % types : 0;
  const double reach = 4 * scene->scene.camera.array.pitch;
  const LensIndex* nearest = nullptr;
  const std::vector<LensIndex> lenses = lattice.within({-reach, -reach}, {reach, reach});
  const auto distance = [&](const LensIndex& lens) {
    const Vec2 at = lattice.centre(lens);
    return at.x * at.x + at.y * at.y;
  };
  for (const LensIndex& lens : lenses)
    if (lattice.type(lens) == wanted && (!nearest || distance(lens) < distance(*nearest)))
      nearest = &lens;
  if (!nearest) return;
  session_.document().select(Selection::of_microlens(*nearest));
  show_part(static_cast<int>(SceneView::Part::camera));
}

}  // namespace plenoflame::desktop
