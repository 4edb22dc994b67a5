#include "widgets/window/main_window.h"

#include <QAction>
#include <QApplication>
#include <QCloseEvent>
#include <QDragEnterEvent>
#include <QElapsedTimer>
#include <QFile>
#include <QFileInfo>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QScreen>
#include <QSplitter>
#include <QStatusBar>
#include <QTabWidget>
#include <QThread>
#include <QToolButton>
#include <QTreeView>
#include <QUrl>
#include <QVBoxLayout>
#include <QWindow>
#include <algorithm>
#include <initializer_list>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "widgets/controls/plot_widget.h"
#include "widgets/controls/side_panel.h"
#include "widgets/controls/theme.h"
#include "widgets/controls/time_bar.h"
#include "widgets/flame/flame_panel.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/design_panel.h"
#include "widgets/panels/rays_panel.h"
#include "widgets/panels/reconstruct_panel.h"
#include "widgets/panels/render_panel.h"
#include "widgets/panels/scene_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "widgets/window/file_tasks.h"
#include "widgets/window/preferences_dialog.h"
#include "widgets/window/view_commands.h"
#include "widgets/window/welcome_page.h"

namespace plenoflame::desktop {
namespace {

constexpr int kAutosaveInterval = 5000;  ///< [ms]
constexpr int kMostRecent = 10;
constexpr int kLongestAppearance = 500;  ///< [ms]
constexpr int kAppearanceStep = 10;      ///< [ms]
constexpr QSize kFirstSize{1500, 950};
constexpr double kSideShare = 0.185;              ///< of the width, that the side panel takes
constexpr int kLeastSide = 220, kMostSide = 400;  ///< [logical pixel]

/// Groups that are open at the first start.
QStringList first_groups() {
  return {"sceneGroup"};
}

}  // namespace

MainWindow::MainWindow(std::unique_ptr<QSettings> settings, const std::string& recovery_folder)
    : settings_(std::move(settings)), chooser_(*settings_) {
  setObjectName("mainWindow");
  setAcceptDrops(true);
  if (!recovery_folder.empty()) recovery_ = std::make_unique<Recovery>(recovery_folder);
  make_views();
  make_side_panel();
  make_status_line();
  connect_panels();
  make_menus();
  connect_session();
  connect_selection();
  connect(&autosave_, &QTimer::timeout, this, [this] {
    if (!recovery_) return;
    try {
      recovery_->keep(session_.document());
    } catch (const Error& error) {
      statusBar()->showMessage(QString::fromUtf8(error.what()), 10000);
    }
  });
  autosave_.start(kAutosaveInterval);
  // The frame needs room, too: a screen that has little more than the window gives it all.
  const QSize room = kShareOfScreen * screen()->availableSize();
  resize(kFirstSize.boundedTo(room));
  if (size() != kFirstSize) setWindowState(Qt::WindowMaximized);
  restoreGeometry(settings_->value("window/geometry").toByteArray());
  split_by_hand_ = split_->restoreState(settings_->value("window/split").toByteArray());
  side_->set_opened(settings_->value("window/groups", first_groups()).toStringList());
  set_dark(settings_->value("window/dark", false).toBool());
  apply_preferences(preferences_of(*settings_));
  if (const auto look = look_from_text(settings_->value("flame/look").toByteArray()))
    session_.document().begin_look(*look);
  update_recent();
  update_title();
  show_welcome(true);
}

MainWindow::~MainWindow() {
  // Widgets go before what they show: members would be gone before children are.
  autosave_.stop();
  delete files_;  // waits for what is being written
  delete takeCentralWidget();
}

void MainWindow::make_views() {
  welcome_ = new WelcomePage(this);
  split_ = new QSplitter(Qt::Horizontal, this);
  split_->setObjectName("workspace");
  side_ = new SidePanel(split_);
  scene_view_ = new SceneView(split_);
  section_ = new SectionView(scene_view_);
  scene_view_->set_section(section_);
  image_ = new ImagePanel(session_.document(), session_.measured());
  reconstruct_ = new ReconstructPanel(session_, chooser_);
  light_field_ = new LightFieldPanel(session_.document(), session_.light_field(), *image_,
                                     reconstruct_->result(), split_);
  for (const int view : {1, 2}) {
    split_->setStretchFactor(view, 1);
    split_->setCollapsible(view, false);
  }
  connect(split_, &QSplitter::splitterMoved, this, [this] { split_by_hand_ = true; });
  auto* workspace = new QWidget(this);
  workspace_ = new QVBoxLayout(workspace);
  workspace_->setContentsMargins(0, 0, 0, 0);
  workspace_->setSpacing(0);
  workspace_->addWidget(split_, 1);
  workspace_->addWidget(new TimeBar(session_, workspace));
  setCentralWidget(workspace);
  connect(welcome_, &WelcomePage::example_chosen, this,
          [this](const QString& name) { open_example(name); });
  connect(welcome_, &WelcomePage::file_chosen, this, [this](const QString& path) { open(path); });
  connect(welcome_, &WelcomePage::back_requested, this, [this] { show_welcome(false); });
}

void MainWindow::make_side_panel() {
  scene_ = new ScenePanel(session_.document());
  rays_ = new RaysPanel(session_.rays());
  render_ = new RenderPanel(session_);
  design_ = new DesignPanel(session_.design());
  flame_ = new FlamePanel(session_.document(), session_.compiler());
  side_->add("sceneGroup", tr("Scene"), scene_);
  side_->add("flameGroup", tr("Flame"), flame_);
  side_->add("designGroup", tr("Design"), design_);
  side_->add("renderGroup", tr("Rendering"), render_);
  side_->add("raysGroup", tr("Rays"), rays_);
  side_->add("histogramGroup", tr("Histogram"), &image_->histogram_plot());
  side_->add("profileGroup", tr("Line profile"), &image_->profile_plot());
  side_->add("reconstructGroup", tr("Reconstruct"), reconstruct_);
}

void MainWindow::make_status_line() {
  pointer_label_ = new QLabel(this);
  pointer_label_->setObjectName("pointerLabel");
  status_line_ = new QToolButton(this);
  status_line_->setObjectName("statusLine");
  status_line_->setAutoRaise(true);
  status_line_->setToolTip(tr("Opens the curve of the error, and what was left out"));
  connect(status_line_, &QToolButton::clicked, this, [this] { side_->open("renderGroup"); });
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
  for (QWidget* widget : std::initializer_list<QWidget*>{files_, pointer_label_, status_line_})
    statusBar()->addPermanentWidget(widget);
}

void MainWindow::connect_panels() {
  // Views cost time: they are made once somebody looks at them.
  connect(light_field_, &LightFieldPanel::views_wanted, this,
          [this] { session_.set_views_wanted(true); });
  connect(light_field_, &LightFieldPanel::export_requested, this, &MainWindow::export_derived);
  connect(&session_.document(), &Document::look_changed, this, [this] {
    const FlameLook& look = session_.document().look();
    scene_view_->set_flame_look(look);
    settings_->setValue("flame/look", look_to_text(look));
  });
  connect(flame_, &FlamePanel::generate_requested, this, &MainWindow::generate_flame);
  connect(flame_, &FlamePanel::import_requested, this, &MainWindow::import_flame);
  connect(flame_, &FlamePanel::mapping_requested, this, &MainWindow::map_grids);
  connect(reconstruct_, &ReconstructPanel::failed, this, &MainWindow::fail);
  connect(reconstruct_, &ReconstructPanel::warned, &session_, &Session::warned);
  connect(reconstruct_, &ReconstructPanel::save_requested, this, &MainWindow::save_reconstruction);
  connect(reconstruct_, &ReconstructPanel::began, this,
          [this] { light_field_->show_tab(LightFieldPanel::Tab::reconstruction); });
  connect(&image_->view(), &ImageView::profile_drawn, this,
          [this] { side_->open("profileGroup"); });
  connect(rays_, &RaysPanel::ray_chosen, section_, &SectionView::set_highlighted);
  connect(rays_, &RaysPanel::ray_chosen, scene_view_, &SceneView::set_highlighted);
  connect(rays_, &RaysPanel::export_requested, this, &MainWindow::export_rays);
  connect(render_, &RenderPanel::failed, this, &MainWindow::fail);
  connect(scene_, &ScenePanel::failed, this, &MainWindow::fail);
  connect(&scene_->model(), &ParameterModel::refusals_changed, this, &MainWindow::update_title);
}

/// Until somebody moves a border each view has at least two fifths of the width.
void MainWindow::place_split() {
  if (split_by_hand_) return;
  const int side = std::clamp(static_cast<int>(kSideShare * width()), kLeastSide, kMostSide);
  const int view = std::max(1, (width() - side) / 2);
  split_->setSizes({side, view, view});
}

void MainWindow::reset_layout() {
  view_commands_->set_full(false);
  split_by_hand_ = false;
  side_->show();
  side_->set_opened(first_groups());
  scene_view_->show_section(false);
  light_field_->show_tab(LightFieldPanel::Tab::raw);
  place_split();
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
  if (QStringList{"tif", "tiff", "png", "pgm", "jpg", "jpeg"}.contains(ending))
    return open_measured(path, then);
  // A flame is put into the scene that is open, which can be undone.
  const bool discards = ending != "vdb";
  if (discards && !may_discard()) return false;
  const auto opened = [this, path, then] {
    show_welcome(false);
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
          // Changes that were made while it was being read count.
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

bool MainWindow::open_new() {
  if (!may_discard()) return false;
  return guarded([&] {
    session_.document().open_text(
        "[camera]\npreset = \"paper-previous-60x60\"\n\n[[flames]]\npreset = \"paper-layered\"\n"
        "position = [\"1 m\", \"0 m\", \"-29 mm\"]\n",
        "untitled.toml");
    ++scenes_opened_;
    show_welcome(false);
  });
}

bool MainWindow::save() {
  scene_->finish_editing();
  const std::string& file = session_.document().file();
  if (file.empty()) return save_as();
  const QString name = QFileInfo(QString::fromStdString(file)).fileName();
  // A file that somebody wrote keeps its comments and its order until there is something to save.
  if (!session_.document().is_modified() && QFileInfo::exists(QString::fromStdString(file))) {
    statusBar()->showMessage(tr("%1 has no changes to save").arg(name) + not_taken(), 8000);
    return true;
  }
  if (!guarded([&] { session_.document().save(file); })) return false;
  statusBar()->showMessage(tr("%1 saved").arg(name) + not_taken(), 8000);
  return true;
}

bool MainWindow::save_as() {
  scene_->finish_editing();
  const QString name =
      chooser_.file_to_write(this, tr("Save the scene"), "scene.toml", tr("Scenes (*.toml)"));
  if (name.isEmpty()) return false;
  if (!guarded([&] { session_.document().save(name.toStdString()); })) return false;
  add_recent(QFileInfo(name).absoluteFilePath());
  statusBar()->showMessage(tr("%1 saved").arg(QFileInfo(name).fileName()) + not_taken(), 8000);
  return true;
}

bool MainWindow::may_discard() {
  if (!session_.document().is_modified() || unattended_) return true;
  QMessageBox box(QMessageBox::Question, tr("Unsaved changes"),
                  tr("The scene \"%1\" has changes that are not saved.")
                      .arg(QString::fromStdString(session_.document().name())),
                  QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
  box.button(QMessageBox::Save)->setText(tr("&Save"));
  box.button(QMessageBox::Discard)->setText(tr("&Discard"));
  box.button(QMessageBox::Cancel)->setText(tr("&Cancel"));
  const int answer = box.exec();
  if (answer == QMessageBox::Save) return save();
  return answer == QMessageBox::Discard;
}

bool MainWindow::begin(const QString& file, const std::function<void()>& then) {
  if (!unattended_ && offer_recovery()) {
    if (!file.isEmpty())
      statusBar()->showMessage(
          tr("%1 was not opened: what you recovered is open").arg(QFileInfo(file).fileName()),
          20000);
    return true;
  }
  return !file.isEmpty() && open(file, then);
}

bool MainWindow::offer_recovery() {
  if (!recovery_) return false;
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
      show_welcome(false);
      recovery_->keep(session_.document());
    }
    Recovery::discard(scene);
    if (wanted) return true;
  }
  return false;
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
  const auto& refused = scene_->model().refusals();
  undo_->setEnabled(document.can_undo() || !refused.empty());
  redo_->setEnabled(document.can_redo());
  undo_->setText(!refused.empty() ? tr("Undo refused value of %1").arg(refused.back().path)
                 : document.can_undo()
                     ? tr("Undo %1").arg(QString::fromStdString(document.undo_text()))
                     : tr("Undo"));
  redo_->setText(document.can_redo()
                     ? tr("Redo %1").arg(QString::fromStdString(document.redo_text()))
                     : tr("Redo"));
}

/// A value that was refused is an edit, too: the last one is taken back.
void MainWindow::undo() {
  if (scene_->model().refusals().empty()) return session_.document().undo();
  scene_->model().forget_refusal();
}

/// Values that are on display but were refused, and are therefore not in the file.
QString MainWindow::not_taken() const {
  QStringList parts;
  for (const auto& refusal : scene_->model().refusals())
    parts << tr("%1 = %2").arg(refusal.path, refusal.text);
  return parts.isEmpty() ? QString()
                         : tr("; not taken, as it was refused: %1").arg(parts.join(", "));
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
    const SensorSpec& sensor = session_.document().camera().sensor;
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
    if (side_->open(panel)) return {};
    QStringList names;
    for (const QAction* group : side_->groups()) names << group->text();
    for (int i = 0; i < light_field_->tabs().count(); ++i) {
      names << light_field_->tabs().tabText(i);
      if (names.back().compare(panel, Qt::CaseInsensitive) != 0) continue;
      light_field_->tabs().setCurrentIndex(i);
      return {};
    }
    return "--panel: there is no panel '" + panel + "'; there are " + names.join(", ");
  }
  return {};
}

void MainWindow::show_part(int index) {
  const auto part = static_cast<SceneView::Part>(index);
  scene_view_->show_part(part);
  section_->show_part(static_cast<SectionView::Part>(index));
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

/// It covers the panels as well, which have nothing to show before there is a scene.
void MainWindow::show_welcome(bool on) {
  if (on) {
    place_welcome();
    welcome_->raise();
    welcome_->setFocus();
  }
  welcome_->setVisible(on);
  // The keyboard does not get at what is covered.
  centralWidget()->setEnabled(!on);
}

void MainWindow::place_welcome() {
  const int top = menuBar()->isNativeMenuBar() ? 0 : menuBar()->geometry().bottom() + 1;
  const int bottom = statusBar()->isVisible() ? statusBar()->geometry().top() : height();
  welcome_->setGeometry(0, top, width(), bottom - top);
}

void MainWindow::resizeEvent(QResizeEvent* event) {
  QMainWindow::resizeEvent(event);
  place_split();
  place_welcome();
}

void MainWindow::showEvent(QShowEvent* event) {
  if (!event->spontaneous()) scene_view_->warm_up();
  QMainWindow::showEvent(event);
  place_welcome();
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
  if (split_by_hand_) settings_->setValue("window/split", split_->saveState());
  settings_->setValue("window/groups", side_->opened());
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
