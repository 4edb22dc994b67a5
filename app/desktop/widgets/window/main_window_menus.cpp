#include <QAction>
#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QStatusBar>
#include <array>

#include <vtkVersion.h>
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "widgets/controls/side_panel.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/image_view.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/scene/section_view.h"
#include "widgets/window/help_window.h"
#include "widgets/window/lens_window.h"
#include "widgets/window/main_window.h"
#include "widgets/window/preferences_dialog.h"
#include "widgets/window/view_commands.h"
#include "widgets/window/welcome_page.h"

namespace plenoflame::desktop {

void MainWindow::make_menus() {
  Document& document = session_.document();
  const auto add = [this](QMenu* menu, const QString& text, const QKeySequence& keys,
                          const char* name, auto act) {
    QAction* const action = menu->addAction(text);
    action->setShortcut(keys);
    action->setObjectName(name);
    connect(action, &QAction::triggered, this, act);
    return action;
  };
  QMenu* const file = menuBar()->addMenu(tr("&File"));
  const auto ask_open = [this] {
    const QString path = chooser_.file_to_read(
        this, tr("Open"),
        tr("Scenes, flames, light fields, a camera's pictures (*.toml *.vdb *.exr *.tif *.tiff "
           "*.png *.pgm *.jpg *.jpeg);;All files (*)"));
    if (!path.isEmpty()) open(path);
  };
  add(file, tr("&New"), QKeySequence::New, "actionNew", [this] { open_new(); });
  add(file, tr("&Open..."), QKeySequence::Open, "actionOpen", ask_open);
  connect(welcome_, &WelcomePage::open_requested, this, ask_open);
  recent_menu_ = file->addMenu(tr("Open &recent"));
  add(file, tr("Measured picture..."), {}, "actionMeasured", [this] { choose_measured(); });
  add(file, tr("&Save"), QKeySequence::Save, "actionSave", [this] { save(); });
  add(file, tr("Save &as..."), QKeySequence("Ctrl+Shift+S"), "actionSaveAs", [this] { save_as(); });
  file->addSeparator();
  QMenu* const exports = file->addMenu(tr("&Export"));
  exports->setObjectName("exportMenu");
  make_export_menu(*exports);
  file->addSeparator();
  add(file, tr("Welcome page"), {}, "actionWelcome",
      [this] { show_welcome(!welcome_->isVisible() || session_.document().is_empty()); });
  add(file, tr("&Quit"), QKeySequence::Quit, "actionQuit", [this] { close(); });

  QMenu* const edit = menuBar()->addMenu(tr("&Edit"));
  undo_ = add(edit, tr("Undo"), QKeySequence::Undo, "actionUndo", [this] { undo(); });
  redo_ = add(edit, tr("Redo"), QKeySequence::Redo, "actionRedo",
              [this] { session_.document().redo(); });
  edit->addSeparator();
  add(edit, tr("Preferences..."), QKeySequence::Preferences, "actionPreferences",
      [this] { show_preferences(); });
  add(edit, tr("Select nothing"), Qt::Key_Escape, "actionDeselect",
      [&document] { document.select({}); });

  QMenu* const render = menuBar()->addMenu(tr("&Render"));
  add(render, tr("Render"), Qt::Key_F5, "actionRender", [this] { session_.start_render(); });
  add(render, tr("Pause or resume"), Qt::Key_F6, "actionPause", [this] {
    if (session_.render().state() == RenderJob::State::paused)
      session_.render().resume();
    else
      session_.render().pause();
  });
  add(render, tr("Stop"), QKeySequence("Shift+F5"), "actionStop",
      [this] { session_.render().stop(); });
  render->addSeparator();
  add(render, tr("Reconstruct the flame..."), {}, "actionReconstruct",
      [this] { side_->open("reconstructGroup"); });
  add(render, tr("Film of a parameter..."), {}, "actionFilm", [this] { make_film(); });

  QMenu* const view = menuBar()->addMenu(tr("&View"));
  make_view_menu(*view);
  view_commands_ =
      new ViewCommands(*this, *scene_view_, *light_field_, {side_, statusBar()}, {view, edit});
  add(view, tr("Reset layout"), {}, "actionReset", [this] { reset_layout(); });

  QMenu* const help = menuBar()->addMenu(tr("&Help"));
  add(help, tr("Documentation"), QKeySequence::HelpContents, "actionHelp", [this] { open_help(); });
  add(help, tr("Guided tour"), {}, "actionTour", [this] { start_tour(); });
  add(help, tr("Keyboard"), QKeySequence("Shift+F1"), "actionKeys", [this] {
    QMessageBox::information(this, tr("Keyboard"),
                             tr("Image: arrows move the selected pixel (Shift: by ten), + and - "
                                "zoom, F fits, 1 shows pixels one to one, "
                                "O outlines\n3-D view: Ctrl+1 scene, 2 flame, 3 camera, 4 array, 5 "
                                "pixel\nF5 render, F6 pause or resume, "
                                "Shift+F5 stop\nCtrl+O open, Ctrl+S save, Ctrl+Z undo, "
                                "Ctrl+Shift+Z redo\nEscape clears the selection\nF1 opens "
                                "the documentation of what has the focus"));
  });
  add(help, tr("About Plenoflame"), {}, "actionAbout", [this] { show_about(); });
}

void MainWindow::make_view_menu(QMenu& menu) {
  using Part = SceneView::Part;
  struct Entry {
    QString text;
    const char* keys;
    Part part;
  };
  const std::array<Entry, 5> parts{{{tr("3-D: scene"), "Ctrl+1", Part::scene},
                                    {tr("3-D: flame"), "Ctrl+2", Part::flame},
                                    {tr("3-D: camera"), "Ctrl+3", Part::camera},
                                    {tr("3-D: array"), "Ctrl+4", Part::array},
                                    {tr("3-D: selected pixel"), "Ctrl+5", Part::pixel}}};
  for (const Entry& entry : parts) {
    QAction* const action = menu.addAction(entry.text);
    action->setShortcut(QKeySequence(entry.keys));
    connect(action, &QAction::triggered, this,
            [this, part = entry.part] { show_part(static_cast<int>(part)); });
  }
  QAction* const next_type = menu.addAction(tr("Next type of microlens"));
  next_type->setShortcut(QKeySequence("Ctrl+T"));
  connect(next_type, &QAction::triggered, this, [this] { select_next_type(); });
  connect(menu.addAction(tr("Compare with a scene...")), &QAction::triggered, this, [this] {
    const QString path =
        chooser_.file_to_read(this, tr("Scene beside this one"), tr("Scenes (*.toml)"));
    if (!path.isEmpty()) compare_with(path);
  });
  connect(menu.addAction(tr("Compare with the saved scene")), &QAction::triggered, this, [this] {
    const std::string& file = session_.document().file();
    if (file.empty()) return fail(tr("The scene was not saved yet."));
    compare_with(QString::fromStdString(file));
  });
  menu.addSeparator();
  QAction* const above = menu.addAction(tr("Section seen from above"));
  above->setCheckable(true);
  connect(above, &QAction::toggled, this, [this](bool on) {
    section_->set_horizontal(on);
    scene_view_->show_section(true);
  });
  dark_ = menu.addAction(tr("Dark theme"));
  dark_->setObjectName("actionDark");
  dark_->setCheckable(true);
  connect(dark_, &QAction::toggled, this, [this](bool on) { set_dark(on); });
  QMenu* const lens = menu.addMenu(tr("Main lens"));
  const auto lens_window = [this](LensDiagrams::Kind kind) {
    auto* const window = new LensDiagrams(kind, session_.lens(), this);
    window->setAttribute(Qt::WA_DeleteOnClose);
    window->show();
  };
  connect(lens->addAction(tr("Lens data...")), &QAction::triggered, this, [this] {
    if (session_.document().is_empty()) return fail(tr("There is no scene yet."));
    auto* const window = new LensTable(session_.document(), this);
    window->setAttribute(Qt::WA_DeleteOnClose);
    connect(window, &LensTable::failed, this, &MainWindow::fail);
    window->show();
  });
  connect(lens->addAction(tr("Spot diagram...")), &QAction::triggered, this,
          [=] { lens_window(LensDiagrams::Kind::spots); });
  connect(lens->addAction(tr("Ray fans...")), &QAction::triggered, this,
          [=] { lens_window(LensDiagrams::Kind::fans); });
  connect(lens->addAction(tr("MTF...")), &QAction::triggered, this,
          [=] { lens_window(LensDiagrams::Kind::contrast); });
  menu.addSeparator();
  QAction* const side = menu.addAction(tr("Side panel"));
  side->setObjectName("actionSide");
  side->setShortcut(Qt::Key_F9);
  connect(side, &QAction::triggered, this, [this] { side_->setVisible(!side_->isVisible()); });
  for (QAction* const group : side_->groups()) menu.addAction(group);
}

void MainWindow::show_preferences() {
  PreferencesDialog dialog(preferences_of(*settings_), this);
  connect(&dialog, &PreferencesDialog::changed, this, [this](const Preferences& wanted) {
    keep_preferences(wanted, *settings_);
    apply_preferences(wanted);
  });
  dialog.exec();
}

void MainWindow::apply_preferences(const Preferences& wanted) {
  session_.set_threads(wanted.threads);
  if (wanted.dark != dark_->isChecked()) set_dark(wanted.dark);
  QFont font = QApplication::font();
  if (wanted.font_points <= 0 || font.pointSize() == wanted.font_points) return;
  font.setPointSize(wanted.font_points);
  QApplication::setFont(font);
}

void MainWindow::update_recent() {
  recent_menu_->clear();
  const QStringList files = settings_->value("files/recent").toStringList();
  for (const QString& path : files)
    connect(recent_menu_->addAction(path), &QAction::triggered, this, [this, path] { open(path); });
  recent_menu_->setEnabled(!files.isEmpty());
  welcome_->set_recent(files);
}

void MainWindow::show_about() {
  QMessageBox::about(
      this, tr("About Plenoflame"),
      tr("<h3>Plenoflame %1</h3><p>What a light-field (plenoptic) camera sees "
         "of a flame.</p>"
         "<p>Qt %2, VTK %3, OpenVDB, Embree, OpenEXR. Kernels: "
         "%4.</p><p>Licence: Apache 2.0</p>")
          .arg(QString::fromUtf8(version().data(), static_cast<int>(version().size())), qVersion(),
               vtkVersion::GetVTKVersion(),
               QString::fromUtf8(name(best_isa()).data(),
                                 static_cast<int>(name(best_isa()).size()))));
}

void MainWindow::open_help() {
  // The page about what has the focus; in the build tree and where docs are
  // installed.
  QString page = "desktop.md";
  for (QWidget* w = QApplication::focusWidget(); w; w = w->parentWidget()) {
    if (w->objectName() == "sceneTree") page = "reference/scene.md";
    if (w->objectName() == "raysGroup") page = "rays.md";
    if (w->objectName() == "reconstructGroup") page = "reconstruct.md";
    if (w == light_field_ && light_field_->shows_views()) page = "light-fields.md";
    if (w->objectName() == "designGroup") page = "design.md";
    if (w->objectName() == "flameGroup") page = "user/flames.md";
  }
  for (const QString& folder : {QCoreApplication::applicationDirPath() + "/" PLENOFLAME_DOC_FOLDER,
                                QString(PLENOFLAME_SOURCE_DOCS)}) {
    const QString path = QDir(folder).filePath(page);
    if (!QFileInfo::exists(path)) continue;
    if (!help_) help_ = new HelpWindow(this);
    help_->show_page(QFileInfo(path).canonicalFilePath());
    return;
  }
  fail(tr("The documentation page %1 is not installed (Debian package plenoflame-doc).").arg(page));
}

}  // namespace plenoflame::desktop
