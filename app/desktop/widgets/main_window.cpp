#include "widgets/main_window.h"

#include <QAction>
#include <QApplication>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QElapsedTimer>
#include <QFile>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QSplitter>
#include <QStackedWidget>
#include <QStatusBar>
#include <QThread>
#include <QTreeView>
#include <QUrl>
#include <QWindow>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "widgets/design_panel.h"
#include "widgets/file_tasks.h"
#include "widgets/flame_panel.h"
#include "widgets/image_panel.h"
#include "widgets/image_view.h"
#include "widgets/light_field_panel.h"
#include "widgets/plot_widget.h"
#include "widgets/rays_panel.h"
#include "widgets/render_panel.h"
#include "widgets/scene_panel.h"
#include "widgets/scene_view.h"
#include "widgets/section_view.h"
#include "widgets/theme.h"
#include "widgets/welcome_page.h"

namespace plenoflame::desktop {
namespace {

constexpr int kAutosaveInterval = 5000;  ///< [ms]
constexpr int kMostRecent = 10;
constexpr int kLongestAppearance = 500;  ///< [ms]
constexpr int kAppearanceStep = 10;      ///< [ms]

}  // namespace

MainWindow::MainWindow(std::unique_ptr<QSettings> settings, const std::string& recovery_folder)
    : settings_(std::move(settings)) {
  setObjectName("mainWindow");
  setAcceptDrops(true);
  setDockNestingEnabled(true);
  if (!recovery_folder.empty()) recovery_ = std::make_unique<Recovery>(recovery_folder);
  pointer_label_ = new QLabel(this);
  pointer_label_->setObjectName("pointerLabel");
  make_views();
  make_docks();
  make_menus();
  connect_session();
  connect_selection();
  busy_label_ = new QLabel(this);
  busy_label_->setObjectName("busyLabel");
  files_ = new FileTasks(this);
  connect(files_, &FileTasks::failed, this, &MainWindow::fail);
  connect(files_, &FileTasks::done, this, [this](const QString& what) {
    statusBar()->showMessage(tr("%1: done").arg(what), 8000);
  });
  connect(files_, &FileTasks::cancelled, this, [this](const QString& what) {
    last_message_ = tr("%1: cancelled").arg(what);
    statusBar()->showMessage(last_message_, 8000);
  });
  connect(files_, &FileTasks::warned, &session_, &Session::warned);
  statusBar()->addPermanentWidget(files_);
  statusBar()->addPermanentWidget(pointer_label_);
  statusBar()->addPermanentWidget(busy_label_);
  connect(&autosave_, &QTimer::timeout, this, [this] {
    if (!recovery_) return;
    try {
      recovery_->keep(session_.document());
    } catch (const Error& error) {
      statusBar()->showMessage(QString::fromUtf8(error.what()), 10000);
    }
  });
  autosave_.start(kAutosaveInterval);
  resize(1500, 950);
  restoreGeometry(settings_->value("window/geometry").toByteArray());
  restoreState(settings_->value("window/state").toByteArray());
  set_dark(settings_->value("window/dark", false).toBool());
  if (const auto look = look_from_text(settings_->value("flame/look").toByteArray()))
    session_.document().begin_look(*look);
  update_recent();
  update_title();
}

MainWindow::~MainWindow() {
  // Widgets go before what they show: members would be gone before children are.
  autosave_.stop();
  delete files_;  // waits for what is being written
  qDeleteAll(findChildren<QDockWidget*>());
  delete takeCentralWidget();
}

void MainWindow::make_views() {
  welcome_ = new WelcomePage(this);
  auto* across = new QSplitter(Qt::Horizontal, this);
  across->setObjectName("workspace");
  auto* left = new QSplitter(Qt::Vertical, across);
  scene_view_ = new SceneView(left);
  section_ = new SectionView(left);
  left->addWidget(scene_view_);
  left->addWidget(section_);
  left->setStretchFactor(0, 3);
  left->setStretchFactor(1, 2);
  image_ = new ImagePanel(session_.document(), across);
  across->addWidget(left);
  across->addWidget(image_);
  across->setStretchFactor(0, 1);
  across->setStretchFactor(1, 1);
  stack_ = new QStackedWidget(this);
  stack_->addWidget(welcome_);
  stack_->addWidget(across);
  setCentralWidget(stack_);
  connect(welcome_, &WelcomePage::example_chosen, this,
          [this](const QString& name) { open_example(name); });
  connect(welcome_, &WelcomePage::file_chosen, this, [this](const QString& path) { open(path); });
  connect(welcome_, &WelcomePage::back_requested, this, [this] { stack_->setCurrentIndex(1); });
}

QDockWidget* MainWindow::add_dock(const char* name, const QString& title, QWidget* content,
                                  Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(content);
  addDockWidget(area, dock);
  return dock;
}

void MainWindow::make_docks() {
  setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
  scene_ = new ScenePanel(session_.document(), this);
  rays_ = new RaysPanel(session_.rays(), this);
  render_ = new RenderPanel(session_, this);
  light_field_ = new LightFieldPanel(session_.document(), session_.light_field(), this);
  design_ = new DesignPanel(session_.design(), this);
  flame_ = new FlamePanel(session_.document(), session_.compiler(), this);
  QDockWidget* const scene = add_dock("sceneDock", tr("Scene"), scene_, Qt::LeftDockWidgetArea);
  QDockWidget* const flame = add_dock("flameDock", tr("Flame"), flame_, Qt::LeftDockWidgetArea);
  QDockWidget* const design = add_dock("designDock", tr("Design"), design_, Qt::LeftDockWidgetArea);
  tabifyDockWidget(scene, flame);
  tabifyDockWidget(flame, design);
  scene->raise();
  QDockWidget* const light_field =
      add_dock("lightFieldDock", tr("Light field"), light_field_, Qt::RightDockWidgetArea);
  // Views cost time: they are made once somebody looks at them.
  connect(light_field, &QDockWidget::visibilityChanged, this, [this](bool visible) {
    if (visible && isVisible()) session_.set_views_wanted(true);
  });
  connect(light_field_, &LightFieldPanel::export_requested, this, &MainWindow::export_derived);
  connect(&session_.document(), &Document::look_changed, this, [this] {
    const FlameLook& look = session_.document().look();
    scene_view_->set_flame_look(look);
    settings_->setValue("flame/look", look_to_text(look));
  });
  connect(flame_, &FlamePanel::generate_requested, this, &MainWindow::generate_flame);
  connect(flame_, &FlamePanel::import_requested, this, &MainWindow::import_flame);
  connect(flame_, &FlamePanel::mapping_requested, this, &MainWindow::map_grids);
  QDockWidget* const render =
      add_dock("renderDock", tr("Rendering"), render_, Qt::BottomDockWidgetArea);
  QDockWidget* const rays = add_dock("raysDock", tr("Rays"), rays_, Qt::BottomDockWidgetArea);
  QDockWidget* const histogram = add_dock("histogramDock", tr("Histogram"),
                                          &image_->histogram_plot(), Qt::BottomDockWidgetArea);
  QDockWidget* const profile = add_dock("profileDock", tr("Line profile"), &image_->profile_plot(),
                                        Qt::BottomDockWidgetArea);
  tabifyDockWidget(render, rays);
  tabifyDockWidget(rays, histogram);
  tabifyDockWidget(histogram, profile);
  render->raise();
  resizeDocks({render}, {230}, Qt::Vertical);
  resizeDocks({scene, light_field}, {330, 300}, Qt::Horizontal);
  connect(image_->findChild<ImageView*>("rawImage"), &ImageView::profile_drawn, profile,
          &QDockWidget::raise);
  connect(rays_, &RaysPanel::ray_chosen, section_, &SectionView::set_highlighted);
  connect(rays_, &RaysPanel::ray_chosen, scene_view_, &SceneView::set_highlighted);
  connect(rays_, &RaysPanel::export_requested, this, &MainWindow::export_rays);
  connect(render_, &RenderPanel::failed, this, &MainWindow::fail);
  connect(scene_, &ScenePanel::failed, this, &MainWindow::fail);
}

void MainWindow::connect_session() {
  Document& document = session_.document();
  connect(&document, &Document::state_changed, this, &MainWindow::update_title);
  connect(&document, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    if (changes.camera) image_->view().set_micro_images(nullptr);
  });
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this,
          [this](const SceneChanges& changes) {
            const auto& scene = session_.compiler().compiled();
            scene_view_->set_scene(scene, changes);
            section_->set_scene(scene);
          });
  connect(&session_.rays(), &RaySelector::rays_changed, this, [this] {
    const auto& rays = session_.rays().rays();
    scene_view_->set_rays(rays, rays_->chosen());
    section_->set_rays(rays, rays_->chosen());
    image_->view().set_marks(rays ? rays->pixels : std::vector<Pixel>{});
  });
  connect(image_, &ImagePanel::pyramid_changed, this,
          [this] { scene_view_->set_image(image_->flux_pyramid()); });
  connect(&session_, &Session::failed, this, [this](const QString& what, const QString& message) {
    last_message_ = message;
    statusBar()->showMessage(what + ": " + message);
  });
  connect(&session_, &Session::warned, this, [this](const QString& message) {
    statusBar()->showMessage(tr("warning: ") + message, 15000);
  });
  connect(&session_.light_field(), &LightFieldJobs::outlines_changed, this, [this] {
    if (image_->outlines_action()->isChecked())
      image_->view().set_micro_images(session_.light_field().outlines());
  });
  connect(image_->outlines_action(), &QAction::toggled, this, [this](bool on) {
    if (on) session_.set_outlines_wanted(true);
    image_->view().set_micro_images(on ? session_.light_field().outlines() : nullptr);
  });
  const auto show_busy = [this] {
    const RenderJob& job = session_.render();
    const bool running = job.state() == RenderJob::State::running;
    const Document& shown = session_.document();
    const bool compiling =
        !shown.is_empty() && shown.is_valid() && !session_.compiler().is_current();
    const bool old = shown.image() && !shown.image_is_current();
    busy_label_->setText(running ? tr("rendering, %1 %").arg(100 * job.status().fraction, 0, 'f', 0)
                         : compiling ? tr("preparing the scene")
                         : old       ? tr("the picture is older than the last change; F5 renders")
                                     : QString());
  };
  connect(&session_.render(), &RenderJob::progressed, this, show_busy);
  connect(&session_.render(), &RenderJob::state_changed, this, show_busy);
  connect(&document, &Document::scene_changed, this, show_busy);
  connect(&document, &Document::image_changed, this, show_busy);
  connect(&session_.compiler(), &SceneCompiler::compiled_changed, this, show_busy);
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
    statusBar()->showMessage(
        tr("distance %1")
            .arg(QString::fromStdString(readable_quantity(distance, Dimension::length, 4))));
  });
  connect(scene_view_, &SceneView::picture_requested, this, &MainWindow::export_picture_of_scene);
  connect(rays_, &RaysPanel::pixel_requested, this, select_pixel);
  connect(section_, &SectionView::lens_clicked, this, select_lens);
  connect(section_, &SectionView::point_clicked, this, select_point);
  connect(&document, &Document::selection_changed, this, &MainWindow::show_selection);
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
  view.set_selected_lens(
      selection.kind == Selection::Kind::microlens ? std::optional(selection.lens) : std::nullopt);
  if (auto* dock = findChild<QDockWidget*>("raysDock");
      dock && selection.kind != Selection::Kind::none)
    dock->raise();
}

bool MainWindow::guarded(const std::function<void()>& function) {
  try {
    function();
    return true;
  } catch (const std::exception& error) {
    fail(QString::fromUtf8(error.what()));
    return false;
  }
}

void MainWindow::fail(const QString& message) {
  last_message_ = message;
  statusBar()->showMessage(message, 20000);
  if (!unattended_) QMessageBox::warning(this, tr("Plenoflame"), message);
}

bool MainWindow::open(const QString& path, const std::function<void()>& then) {
  const QString ending = QFileInfo(path).suffix().toLower();
  // A flame is put into the scene that is open, which can be undone.
  const bool discards = ending != "vdb";
  if (discards && !may_discard()) return false;
  const auto opened = [this, path, then] {
    stack_->setCurrentIndex(1);
    add_recent(QFileInfo(path).absoluteFilePath());
    if (then) then();
  };
  if (ending == "exr" || ending == "vdb") {
    auto content = std::make_shared<FileContent>();
    files_->add(
        tr("opening %1").arg(QFileInfo(path).fileName()),
        [content, path](const Execution& execution) {
          *content = Document::read(path.toStdString(), execution.stop);
        },
        [this, content, path, opened, discards, number = scenes_opened_,
         before = session_.document().scene()] {
          // What was done while it was being read counts.
          if (number != scenes_opened_) {
            last_message_ = tr("%1 was not opened: another scene was, while it was being read")
                                .arg(QFileInfo(path).fileName());
            statusBar()->showMessage(last_message_, 20000);
            return;
          }
          if (discards && !(session_.document().scene() == before) && !may_discard()) return;
          if (guarded([&] { session_.document().open(std::move(*content)); })) opened();
        });
    return true;
  }
  if (!guarded([&] { session_.document().open(path.toStdString()); })) return false;
  ++scenes_opened_;
  opened();
  return true;
}

bool MainWindow::is_file_busy() const {
  return files_->busy();
}

bool MainWindow::open_example(const QString& name) {
  if (!may_discard()) return false;
  return guarded([&] {
    QFile file(":/examples/" + name + ".toml");
    if (!file.open(QIODevice::ReadOnly))
      throw FileError("there is no example " + name.toStdString());
    session_.document().open_text(file.readAll().toStdString(), name.toStdString() + ".toml");
    ++scenes_opened_;
    stack_->setCurrentIndex(1);
  });
}

bool MainWindow::save() {
  const std::string& file = session_.document().file();
  if (file.empty()) return save_as();
  const QString name = QFileInfo(QString::fromStdString(file)).fileName();
  // A file that somebody wrote keeps its comments and its order until there is something to save.
  if (!session_.document().is_modified() && QFileInfo::exists(QString::fromStdString(file))) {
    statusBar()->showMessage(tr("%1 has no changes to save").arg(name), 8000);
    return true;
  }
  if (!guarded([&] { session_.document().save(file); })) return false;
  statusBar()->showMessage(tr("%1 saved").arg(name), 8000);
  return true;
}

bool MainWindow::save_as() {
  const QString name = ask_save_name(tr("Save the scene"), "scene.toml", tr("Scenes (*.toml)"));
  if (name.isEmpty()) return false;
  if (!guarded([&] { session_.document().save(name.toStdString()); })) return false;
  add_recent(QFileInfo(name).absoluteFilePath());
  statusBar()->showMessage(tr("%1 saved").arg(QFileInfo(name).fileName()), 8000);
  return true;
}

QString MainWindow::ask_save_name(const QString& title, const QString& suggestion,
                                  const QString& filter) {
  const QString folder = settings_->value("files/folder").toString();
  QString name = QFileDialog::getSaveFileName(
      this, title, folder.isEmpty() ? suggestion : folder + "/" + suggestion, filter);
  if (name.isEmpty()) return name;
  if (QFileInfo(name).suffix().isEmpty()) name += "." + QFileInfo(suggestion).suffix();
  settings_->setValue("files/folder", QFileInfo(name).absolutePath());
  return name;
}

bool MainWindow::may_discard() {
  if (!session_.document().is_modified() || unattended_) return true;
  const auto answer =
      QMessageBox::question(this, tr("Unsaved changes"),
                            tr("The scene \"%1\" has changes that are not saved.")
                                .arg(QString::fromStdString(session_.document().name())),
                            QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel);
  if (answer == QMessageBox::Save) return save();
  return answer == QMessageBox::Discard;
}

void MainWindow::offer_recovery() {
  if (!recovery_) return;
  const auto left = recovery_->left_behind();
  if (recovery_->ended_badly() && left.empty())
    statusBar()->showMessage(
        tr("Plenoflame ended unexpectedly the last time. Nothing was unsaved then."), 20000);
  for (const RecoveredScene& scene : left) {
    const QString name =
        scene.file.empty() ? tr("a scene without a name") : QString::fromStdString(scene.file);
    const bool wanted =
        unattended_ ||
        QMessageBox::question(
            this, tr("Recovery"),
            tr("Plenoflame ended without saving %1. Open it as it was then?").arg(name)) ==
            QMessageBox::Yes;
    if (wanted && guarded([&] { session_.document().recover(scene); })) {
      stack_->setCurrentIndex(1);
      recovery_->keep(session_.document());
    }
    Recovery::discard(scene);
    if (wanted) return;
  }
}

void MainWindow::add_recent(const QString& path) {
  QStringList files = settings_->value("files/recent").toStringList();
  files.removeAll(path);
  files.prepend(path);
  while (files.size() > kMostRecent) files.removeLast();
  settings_->setValue("files/recent", files);
  update_recent();
}

void MainWindow::update_title() {
  const Document& document = session_.document();
  setWindowTitle(document.is_empty()
                     ? tr("Plenoflame")
                     : tr("%1[*] - Plenoflame").arg(QString::fromStdString(document.name())));
  setWindowModified(document.is_modified());
  welcome_->set_open(!document.is_empty());
  undo_->setEnabled(document.can_undo());
  redo_->setEnabled(document.can_redo());
  undo_->setText(document.can_undo()
                     ? tr("Undo %1").arg(QString::fromStdString(document.undo_text()))
                     : tr("Undo"));
  redo_->setText(document.can_redo()
                     ? tr("Redo %1").arg(QString::fromStdString(document.redo_text()))
                     : tr("Redo"));
}

bool MainWindow::is_settled() const {
  const Session& session = session_;
  auto& mutable_session = const_cast<Session&>(session);
  const RenderJob::State state = mutable_session.render().state();
  return !files_->busy() &&
         (mutable_session.document().is_empty() ||
          (mutable_session.compiler().is_current() && state != RenderJob::State::running &&
           mutable_session.document().image() && image_->pyramid() && image_->is_current() &&
           mutable_session.rays().is_current() && scene_view_->is_current()));
}

QString MainWindow::apply_options(const QString& pixel, const QString& part, const QString& panel,
                                  bool dark) {
  if (dark) set_dark(true);
  if (!pixel.isEmpty()) {
    const QStringList parts = pixel.split(',');
    bool x_good = false, y_good = false;
    const int x = parts.value(0).toInt(&x_good), y = parts.value(1).toInt(&y_good);
    if (parts.size() != 2 || !x_good || !y_good)
      return "--pixel: '" + pixel + "' is not of the form X,Y: two whole numbers";
    const SensorSpec& sensor = session_.document().scene().camera.sensor;
    if (!session_.document().is_empty() &&
        (x < 0 || y < 0 || x >= sensor.columns || y >= sensor.rows))
      return QString("--pixel: %1 is outside of the sensor of %2 x %3 pixels")
          .arg(pixel)
          .arg(sensor.columns)
          .arg(sensor.rows);
    session_.document().select(Selection::of_pixel(x, y));
  }
  if (!part.isEmpty()) {
    const int index = QStringList{"scene", "flame", "camera", "array", "pixel"}.indexOf(part);
    if (index < 0) return "--part: '" + part + "' is none of scene, flame, camera, array, pixel";
    show_part(index);
  }
  if (!panel.isEmpty()) {
    QStringList names;
    for (QDockWidget* dock : findChildren<QDockWidget*>()) {
      names << dock->windowTitle();
      if (dock->windowTitle().compare(panel, Qt::CaseInsensitive) != 0) continue;
      dock->show();
      dock->raise();
      return {};
    }
    return "--panel: there is no panel '" + panel + "'; there are " + names.join(", ");
  }
  return {};
}

void MainWindow::show_part(int index) {
  const auto part = static_cast<SceneView::Part>(index);
  using Part = SceneView::Part;
  scene_view_->show_part(part);
  section_->show_part(part == Part::scene || part == Part::flame ? SectionView::Part::scene
                      : part == Part::camera                     ? SectionView::Part::camera
                                                                 : SectionView::Part::array);
}

bool MainWindow::save_screenshot(const QString& path) {
  scene_view_->picture();
  // grab() draws what the graphics library drew elsewhere as well.
  if (!grab().save(path)) {
    fail(tr("'%1' cannot be written").arg(path));
    return false;
  }
  return true;
}

void MainWindow::set_dark(bool dark) {
  apply_theme(dark);
  if (dark_->isChecked() != dark) dark_->setChecked(dark);
  scene_view_->set_dark(dark);
  settings_->setValue("window/dark", dark);
}

void MainWindow::appear() {
  show();
  QElapsedTimer since;
  since.start();
  bool exposed = false;
  while (!exposed && since.elapsed() < kLongestAppearance) {
    exposed = windowHandle()->isExposed();
    QApplication::processEvents(QEventLoop::ExcludeUserInputEvents, kAppearanceStep);
    if (!exposed) QThread::msleep(1);
  }
}

void MainWindow::showEvent(QShowEvent* event) {
  if (!event->spontaneous()) scene_view_->warm_up();
  QMainWindow::showEvent(event);
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (!may_discard()) {
    event->ignore();
    return;
  }
  if (files_->busy() && !unattended_ &&
      QMessageBox::question(this, tr("Files are being written"),
                            tr("Something is still being read or written. Cancel it and quit?")) !=
          QMessageBox::Yes) {
    event->ignore();
    return;
  }
  files_->cancel_all();
  settings_->setValue("window/geometry", saveGeometry());
  settings_->setValue("window/state", saveState());
  session_.render().stop();
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  const auto urls = event->mimeData()->urls();
  if (urls.size() == 1 && urls.front().isLocalFile()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  const auto urls = event->mimeData()->urls();
  if (urls.size() != 1 || !urls.front().isLocalFile()) return;
  event->acceptProposedAction();
  open(urls.front().toLocalFile());
}

}  // namespace plenoflame::desktop
